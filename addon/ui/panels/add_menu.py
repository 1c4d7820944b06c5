"""The node in the shader editor's menu Add > Shader."""

from __future__ import annotations

import bpy

from ...model.parameter import GROUP_NAME
from ...nodes.compatibility import UnsupportedError
from ...preparation.guard import guarded
from ...scene.new_materials import add_node
from ..polls import supported


def edited_material(space: bpy.types.Space | None) -> bpy.types.Material | None:
    """Return the material whose nodes an editor shows, or None."""
    tree = getattr(space, "node_tree", None)
    return next((material for material in bpy.data.materials if tree is not None and material.node_tree == tree), None)


class AddNode(bpy.types.Operator):
    """Add the node of a nested dielectric to a material."""

    bl_idname = "nested_dielectric.add_node"
    bl_label = "Add Nested Dielectric"
    bl_description = (
        "Add glass, a liquid or ice that knows the media it touches, plugged into the material's outputs where "
        "these are free"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        material = edited_material(context.space_data)
        if material is None:
            cls.poll_message_set("Open a material in the Shader Editor")
            return False
        if not context.space_data.edit_tree.is_editable:
            cls.poll_message_set(f"Material {material.name!r} belongs to a library; make it local first")
            return False
        return supported(cls)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        context.space_data.cursor_location_from_region(event.mouse_region_x, event.mouse_region_y)
        result = self.execute(context)
        if "FINISHED" in result:
            bpy.ops.node.translate_attach_remove_on_cancel("INVOKE_DEFAULT")
        return result

    def execute(self, context: bpy.types.Context) -> set[str]:
        space = context.space_data
        try:
            node, plugged = add_node(edited_material(space), space.edit_tree)
        except UnsupportedError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for other in space.edit_tree.nodes:
            other.select = other == node
        space.edit_tree.nodes.active = node
        node.location = space.cursor_location
        if not plugged:
            self.report({"INFO"}, f"Plug Surface of {node.name!r} in where the material's surface comes from")
        return {"FINISHED"}


@guarded("while a panel was drawn", writes=False)
def draw_entry(self: bpy.types.Menu, context: bpy.types.Context) -> None:
    """Draw the node as an entry of a menu of Blender's."""
    if edited_material(context.space_data) is not None:
        self.layout.separator()
        self.layout.operator(AddNode.bl_idname, text=GROUP_NAME)


CLASSES = (AddNode,)
