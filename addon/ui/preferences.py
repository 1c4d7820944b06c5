"""What users may choose for all files."""

from typing import Any

import bpy

from ..model.folders import PACKAGE
from ..model.manifest import manifest
from ..scene.preset_library import user_folder
from . import asset_library

CLEAN, EDITED = "CLEAN", "EDITED"
FIT, MEASURED = "FIT", "MEASURED"

MATERIALS = (
    (CLEAN, "Clean Copy", "A material that is as the preset has it; the edited one stays as it is"),
    (EDITED, "Use Edited", "The material of this file that was made of the preset and edited since"),
)
"""Which material objects get where one of the preset was edited."""

DEPTHS = (
    (FIT, "Fit to Object", "The preset's colour shows in a body as thick as the object"),
    (MEASURED, "As Measured", "The preset's colour shows at the thickness it was measured at, in the scene's units"),
)
"""How thick a body is that shows a preset's colour."""


class Preferences(bpy.types.AddonPreferences):
    """The extension's preferences."""

    bl_idname = PACKAGE

    material: bpy.props.EnumProperty(
        name="Edited Material",
        description="What objects get that a preset is assigned to where the file's material of it was edited",
        items=MATERIALS,
    )
    depth: bpy.props.EnumProperty(
        name="Colour Depth", description="How thick a body shows the colour of a preset that is assigned", items=DEPTHS
    )
    preset_folder: bpy.props.StringProperty(
        name="My Presets", description="Folder of your own presets; empty for the extension's own", subtype="DIR_PATH"
    )
    asset_library: bpy.props.BoolProperty(
        name="Asset Library",
        description="List all media in the Asset Browser, to be dragged onto objects",
        default=True,
        update=lambda self, context: asset_library.follow(self.asset_library),
    )

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column(heading="Assigning Presets")
        column.prop(self, "material")
        column.prop(self, "depth")
        column = layout.column()
        column.prop(self, "preset_folder", placeholder=str(user_folder()))
        row = column.row(heading="Media to Drag")
        row.enabled = asset_library.is_there()
        row.prop(self, "asset_library")
        row = layout.row()
        row.operator("wm.url_open", text="Manual", icon="HELP").url = manifest()["website"]
        folder = row.row()
        folder.enabled = user_folder().is_dir()
        folder.operator("wm.path_open", text="Open My Presets", icon="FILE_FOLDER").filepath = str(user_folder())


def preference(name: str) -> Any:
    """Return what the user has chosen, or the default where Blender keeps no preferences of the extension."""
    addon = bpy.context.preferences.addons.get(PACKAGE)
    if addon is not None and addon.preferences is not None:
        return getattr(addon.preferences, name)
    return Preferences.bl_rna.properties[name].default


CLASSES = (Preferences,)
