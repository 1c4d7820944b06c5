"""Operators of presets: giving them to objects, fitting their colour, and keeping presets of the user's own."""

import bpy

from ...model.files import WriteError
from ...model.parameters import ParameterError
from ...model.presets import GROUPS, key_of, renamed
from ...scene import media
from ...scene.materials import measured_depth
from ...scene.preset_library import (
    USER_GROUP,
    catalogue,
    delete_user_preset,
    is_built_in,
    load_preset,
    save_user_preset,
)
from ...scene.preset_materials import (
    edited_material,
    fit_depth,
    linked_parameters,
    preset_from,
    preset_material,
    preset_of,
)
from ...scene.shapes import thickness
from ..operators.operators import active_medium
from ..polls import supported
from ..preferences import DEPTHS, EDITED, FIT, MATERIALS, MEASURED, preference
from .preset_pictures import items, own_items, searched_items

_GROUP_ITEMS = tuple((group, group, "") for group in (*GROUPS, USER_GROUP))


def targets(context: bpy.types.Context) -> list[bpy.types.Object]:
    """The selected objects that can be media, or else the active object."""
    selected = [obj for obj in context.selected_editable_objects or () if obj.type in media.SOLID_TYPES]
    return selected or [obj for obj in [context.object] if obj is not None and obj.type in media.SOLID_TYPES]


class AssignPreset(bpy.types.Operator):
    """Make the selected objects media of a preset: glass, water, wine, gems and others"""

    bl_idname = "nested_dielectric.assign_preset"
    bl_label = "Assign Preset"
    bl_options = {"REGISTER", "UNDO"}
    bl_property = "found"

    preset: bpy.props.EnumProperty(
        name="Preset", description="What the objects are to be", items=lambda self, context: items()
    )
    found: bpy.props.EnumProperty(
        name="Found", items=lambda self, context: searched_items(), options={"HIDDEN", "SKIP_SAVE"}
    )
    material: bpy.props.EnumProperty(
        name="Material",
        description="What to do where the file's material of the preset was edited",
        items=MATERIALS,
        options={"SKIP_SAVE"},
    )
    depth: bpy.props.EnumProperty(
        name="Depth", description="How thick a body shows the preset's colour", items=DEPTHS, options={"SKIP_SAVE"}
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        preset = catalogue().presets.get(properties.preset) if properties.is_property_set("preset") else None
        if preset is None:
            return cls.__doc__
        return f"Make the selected objects {preset.name}: {preset.description.rstrip('.')}"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not targets(context):
            cls.poll_message_set("Select a mesh, curve, surface, text or metaball")
            return False
        return supported(cls)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        for name in ("material", "depth"):
            if not self.properties.is_property_set(name):
                setattr(self, name, preference(name))
        if self.properties.is_property_set("preset"):
            return self.execute(context)
        context.window_manager.invoke_search_popup(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        if self.properties.is_property_set("found"):
            self.preset = self.found
            self.property_unset("found")
        objects = targets(context)
        try:
            loaded = load_preset(self.preset)
            edited = edited_material(loaded, objects)
            material = preset_material(self.preset, objects, fit=self.depth == FIT, use_edited=self.material == EDITED)
            for obj in objects:
                media.assign(obj, material)
        except ParameterError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self.report({"INFO"}, f"{material.name} assigned to {', '.join(obj.name for obj in objects)}")
        if edited is not None and edited != material:
            self.report(
                {"INFO"},
                f"{edited.name!r} was edited, so {material.name!r}, which is as the preset has it, was assigned; "
                "to have the edited one, choose Material: Use Edited",
            )
        elif edited is not None:
            text = f"{edited.name!r} was edited; Material: Clean Copy is as the preset {loaded.name!r} has it"
            self.report({"INFO"}, text)
        return {"FINISHED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.prop(self, "preset")
        preset = load_preset(self.preset)
        choice = layout.column()
        choice.enabled = edited_material(preset, targets(context)) is not None
        choice.prop(self, "material")
        choice = layout.column()
        choice.enabled = preset.has_colour
        choice.prop(self, "depth")


class FitDepth(bpy.types.Operator):
    """Set how thick a body is that shows the medium's colour as it is: thinner ones are paler, thicker ones darker"""

    bl_idname = "nested_dielectric.fit_depth"
    bl_label = "Fit Depth"
    bl_options = {"REGISTER", "UNDO"}

    depth: bpy.props.EnumProperty(
        name="Depth",
        description="How thick a body shows the medium's colour",
        items=(
            (FIT, "Active Object", "As thick as the active object: the mean way through it"),
            (MEASURED, "As Measured", "As thick as what the preset was measured at, in the scene's units"),
        ),
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        how = {
            FIT: "as thick as the active object, the mean way through it",
            MEASURED: "as thick as what its preset was measured at",
        }
        return f"Let the medium have its colour in a body {how[properties.depth]}"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return poll_editable(cls, context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        material = active_medium(context)
        try:
            depth = self.wanted(context.object, material)
            fit_depth(material, depth)
        except ParameterError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        length = bpy.utils.units.to_string("METRIC", "LENGTH", depth * context.scene.unit_settings.scale_length)
        self.report({"INFO"}, f"{material.name} has its colour in a body {length} thick")
        return {"FINISHED"}

    def wanted(self, obj: bpy.types.Object | None, material: bpy.types.Material) -> float:
        """The depth to set. Raises :class:`ParameterError` where there is none."""
        if self.depth == MEASURED:
            preset = preset_of(material)
            if preset is None:
                raise ParameterError(f"{material.name!r} knows no preset; fit its depth to the active object")
            return measured_depth(preset)
        if obj is None:
            raise ParameterError("There is no active object to fit the depth to; select one")
        depth = thickness(obj)
        if depth <= 0.0:
            raise ParameterError(f"{obj.name!r} has no thickness; make it a closed mesh")
        return depth


def poll_editable(cls: type[bpy.types.Operator], context: bpy.types.Context) -> bool:
    """Grey an operator out unless the active object is a medium whose material may change."""
    material = active_medium(context)
    if material is None:
        cls.poll_message_set("The active object is no medium; assign a preset to it first")
    elif not material.is_editable:
        cls.poll_message_set(f"Material {material.name!r} belongs to a library; make it local first")
    return material is not None and material.is_editable


class SavePreset(bpy.types.Operator):
    """Keep the active medium as a preset of your own, for all files"""

    bl_idname = "nested_dielectric.save_preset"
    bl_label = "Save Preset"
    bl_options = {"REGISTER"}

    name: bpy.props.StringProperty(name="Name", description="What menus call it", options={"SKIP_SAVE"})
    group: bpy.props.EnumProperty(
        name="Group", description="Where menus show it", items=_GROUP_ITEMS, default=USER_GROUP, options={"SKIP_SAVE"}
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
    """Give a preset of your own another name"""

    bl_idname = "nested_dielectric.rename_preset"
    bl_label = "Rename Preset"

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
    """Delete a preset of your own. Materials that were made of it stay"""

    bl_idname = "nested_dielectric.delete_preset"
    bl_label = "Delete Preset"

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


CLASSES = (AssignPreset, FitDepth, SavePreset, RenamePreset, DeletePreset)
