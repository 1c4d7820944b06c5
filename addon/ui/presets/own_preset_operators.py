"""Operators of presets of the user's own: saving, renaming and deleting them."""

import bpy

from ...model.files import WriteError
from ...model.parameter import ParameterError
from ...model.presets import GROUPS, key_of, renamed
from ...scene.preset_library import (
    USER_GROUP,
    catalogue,
    delete_user_preset,
    is_built_in,
    load_preset,
    save_user_preset,
)
from ...scene.preset_materials import linked_parameters, preset_from, preset_of
from ..active_medium import active_medium
from .preset_pictures import own_items

GROUP_ITEMS = tuple((group, group, "") for group in (*GROUPS, USER_GROUP))


class SavePreset(bpy.types.Operator):
    """Save the active medium as a preset."""

    bl_idname = "nested_dielectric.save_preset"
    bl_label = "Save Preset"
    bl_description = "Keep the active medium as a preset of your own, for all files"
    bl_options = {"REGISTER"}

    name: bpy.props.StringProperty(name="Name", description="What menus call it", options={"SKIP_SAVE"})
    group: bpy.props.EnumProperty(
        name="Group", description="Where menus show it", items=GROUP_ITEMS, default=USER_GROUP, options={"SKIP_SAVE"}
    )
    tags: bpy.props.StringProperty(
        name="Tags", description="Words to find it by, with commas between them", options={"SKIP_SAVE"}
    )
    text: bpy.props.StringProperty(name="Description", description="What it is, in a sentence", options={"SKIP_SAVE"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if active_medium(context) is None:
            cls.poll_message_set("The active object is no medium; assign a preset to it first")
            return False
        return True

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        material = active_medium(context)
        made_of = preset_of(material)
        if not self.name:
            name = material.name if made_of is None else made_of.name
            self.name = f"My {name}" if is_built_in("", name) else name
        if made_of is not None:
            self.group, self.tags = catalogue().group_of(made_of.key), ", ".join(made_of.tags)
            self.text = made_of.description
        return context.window_manager.invoke_props_dialog(self, width=360, confirm_text="Save")

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        for name in ("name", "group", "tags", "text"):
            layout.prop(self, name)
        try:
            key = key_of(self.name)
        except ParameterError:
            return
        if is_built_in(key, self.name.strip()):
            note = layout.row()
            note.alert = True
            note.label(text="The extension has a preset of this name; choose another", icon="ERROR")
        elif key in catalogue().own:
            layout.label(text=f"Replaces your preset {catalogue().presets[key].name}", icon="INFO")

    def execute(self, context: bpy.types.Context) -> set[str]:
        material = active_medium(context)
        before = catalogue().own
        name, tags = self.name or material.name, self.tags.split(",")
        try:
            preset = preset_from(material, name, self.group, tags, self.text.strip())
            path = save_user_preset(preset)
        except (ParameterError, WriteError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for linked in linked_parameters(material):
            self.report({"WARNING"}, f"{material.name!r}: other nodes make {linked}, which no preset can hold")
        self.report({"INFO"}, f"Preset {preset.name} {'replaced' if preset.key in before else 'saved'}: {path}")
        return {"FINISHED"}


class _OwnPreset(bpy.types.Operator):
    """What operators on a preset of the user's share."""

    bl_options = {"INTERNAL"}

    preset: bpy.props.EnumProperty(
        name="Preset", description="A preset of your own", items=lambda self, context: own_items()
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not catalogue().own:
            cls.poll_message_set("There are no presets of your own; Save Preset makes one of the active medium")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            self.report({"INFO"}, self.change())
        except (ParameterError, WriteError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class RenamePreset(_OwnPreset):
    """Rename a preset of the user's."""

    bl_idname = "nested_dielectric.rename_preset"
    bl_label = "Rename Preset"
    bl_description = "Give a preset of your own another name"

    name: bpy.props.StringProperty(name="Name", description="What menus call it", options={"SKIP_SAVE"})

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        self.name = self.name or catalogue().presets[self.preset].name
        return context.window_manager.invoke_props_dialog(self, confirm_text="Rename")

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.prop(self, "name")

    def change(self) -> str:
        old = load_preset(self.preset)
        new = renamed(old, self.name)
        if new.key != old.key and new.key in catalogue().own:
            raise ParameterError(f"{new.name!r} is another preset of yours; choose another name")
        save_user_preset(new)
        if new.key != old.key:
            delete_user_preset(old.key)
        return f"{old.name} is called {new.name} now"


class DeletePreset(_OwnPreset):
    """Delete a preset of the user's."""

    bl_idname = "nested_dielectric.delete_preset"
    bl_label = "Delete Preset"
    bl_description = "Delete a preset of your own. Materials that were made of it stay"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        return context.window_manager.invoke_confirm(
            self,
            event,
            title="Delete Preset",
            message=f"{catalogue().presets[self.preset].name} cannot be brought back",
            confirm_text="Delete",
            icon="WARNING",
        )

    def change(self) -> str:
        name = load_preset(self.preset).name
        delete_user_preset(self.preset)
        return f"Preset {name} deleted"


CLASSES = (SavePreset, RenamePreset, DeletePreset)
