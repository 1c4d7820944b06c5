"""Checks of what lights a scene: lights that get lost, and what disturbs the wavelengths of dispersed light."""

from __future__ import annotations

from ..scene.lights import light_carriers, listed_lights, lobe_lights
from ..scene.materials import dielectrics
from ..scene.media import dispersing_materials, media
from .finding import Finding
from .inspection import Inspection
from .kinds import LIGHTS_CHANGED, LINKED_LOBES, LOST_LIGHT, PORTAL, VECTOR_PASS


def dispersion_findings(inspection: Inspection) -> list[Finding]:
    """Return what else uses the portals and the motion blur that carry wavelengths, where media disperse."""
    scene = inspection.scene
    if not dispersing_materials(scene):
        return []
    findings = [
        Finding(
            PORTAL,
            obj.name,
            f"has a Ray Portal in material {slot.material.name!r}; light through it is taken for a single colour by media",
            "remove it, or switch Disperse off in this scene",
        )
        for obj in scene.objects
        for slot in obj.material_slots
        if slot.material is not None and slot.material.node_tree is not None
        if any(node.bl_idname == "ShaderNodeBsdfRayPortal" for node in slot.material.node_tree.nodes)
    ]
    findings += [
        Finding(
            VECTOR_PASS,
            layer.name,
            "has a Vector pass, which Cycles leaves out with the motion blur that dispersion needs",
            "render the pass with Disperse and motion blur off",
        )
        for layer in scene.view_layers
        if layer.use_pass_vector
    ]
    return findings


def light_findings(inspection: Inspection) -> list[Finding]:
    """Return lights whose light gets lost between rays and lobes, where there are media."""
    scene = inspection.scene
    if not inspection.objects:
        return []
    findings = [
        Finding(
            LOST_LIGHT,
            transport.light,
            "is left out of refraction or reflection by its Ray Visibility, and no lobe carries it, because "
            f"{transport.reason}",
            "switch Transmission and Glossy on, or give it a plain colour and strength",
        )
        for transport in light_carriers(scene)
        if transport.reason
    ]
    carried = lobe_lights(scene)
    linked = {
        material: obj
        for obj in reversed(media(scene))
        for _, material in dielectrics(obj)
        if material.library is not None and carried
    }
    findings += [
        Finding(
            LINKED_LOBES,
            obj.name,
            f"has the linked material {material.name!r}, whose lobes carry none of this scene's lights, such as "
            f"{carried[0].name!r}",
            "make the material local, or switch Transmission and Glossy on in the Ray Visibility of the lights",
        )
        for material, obj in linked.items()
    ]
    if listed_lights(scene) != carried:
        findings.append(
            Finding(
                LIGHTS_CHANGED,
                scene.name,
                "has other lights for direct refraction and reflection than its media know",
                "prepare it again",
            )
        )
    return findings
