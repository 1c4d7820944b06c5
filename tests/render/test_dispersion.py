"""Light that is split into its colours, against Snell's law, brute force and white."""

import inspect

import bpy
import colour
import numpy as np
import pytest
from references import reference_tiles
from scenes import (
    add_box,
    add_camera,
    add_mesh,
    add_plane,
    add_sphere,
    assert_same_picture,
    batches,
    cycles_glass,
    diffuse,
    emission,
    fresnel,
    native,
    new_scene,
    render,
    set_half_world,
    set_world,
)

import nested_dielectric as nd
from nested_dielectric.model import dispersion, presets
from nested_dielectric.nodes import compatibility
from nested_dielectric.scene.materials import material_table

SF11 = presets.load_preset("sf11").parameters
WATER = presets.load_preset("water").parameters


def index(medium, wavelength):
    """The published Sellmeier index of a preset."""
    return dispersion.sellmeier_ior(medium["sellmeier_b"], medium["sellmeier_c"], wavelength)


def dispersing_scene(resolution=48):
    """A scene in which paths have wavelengths."""
    scene = new_scene(resolution)
    scene.render.use_motion_blur = True
    scene.render.motion_blur_shutter = 0.0
    return scene


def material(medium, name="Glass", **keywords):
    """A nested dielectric of a preset's curve that lets no light pass straight."""
    curve = {key: medium[key] for key in ("ior", "dispersion_model", "sellmeier_b", "sellmeier_c")}
    return nd.new_material(name, **{"shadow_mode": "BLACK", "disperse": True} | curve | keywords)


def line(tmp_path, *wavelengths):
    """A distribution of lines of equal power, 0.02 nm wide."""
    path = tmp_path / f"{'-'.join(map(str, wavelengths))}.csv"
    rows = [f"{nm + step},{power}" for nm in wavelengths for step, power in ((-0.01, 0.0), (0.0, 1.0), (0.01, 0.0))]
    path.write_text("\n".join(rows))
    return str(path)


def set_direction_world():
    """A world that shows the direction of a ray as colours from 0 to 1."""
    tree = set_world()
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    scale = tree.nodes.new("ShaderNodeVectorMath")
    scale.operation = "MULTIPLY_ADD"
    scale.inputs[1].default_value = scale.inputs[2].default_value = (0.5, 0.5, 0.5)
    tree.links.new(coordinates.outputs["Generated"], scale.inputs[0])
    tree.links.new(scale.outputs[0], tree.nodes["Background"].inputs["Color"])


def set_band_world():
    """Bright bands on black."""
    tree = set_world()
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    wave = tree.nodes.new("ShaderNodeTexWave")
    wave.inputs["Scale"].default_value = 3.0
    step = tree.nodes.new("ShaderNodeMath")
    step.operation = "GREATER_THAN"
    tree.links.new(coordinates.outputs["Generated"], wave.inputs["Vector"])
    tree.links.new(wave.outputs["Color"], step.inputs[0])
    tree.links.new(step.outputs[0], tree.nodes["Background"].inputs["Color"])


APEX = 30.0


def prism(mat, priority=None):
    """A prism whose first face looks at a camera on the negative Y axis and whose second slopes by the apex angle."""
    width = 2.0 * np.tan(np.radians(APEX))

    def build(bm):
        outline = ((-1.0, 0.0), (1.0, 0.0), (-1.0, width))
        low, high = ([bm.verts.new((x, y, z)) for x, y in outline] for z in (-1.0, 1.0))
        bm.faces.new(low[::-1])
        bm.faces.new(high)
        for i in range(3):
            j = (i + 1) % 3
            bm.faces.new((low[i], low[j], high[j], high[i]))

    return add_mesh("Prism", build, mat, priority)


def deviation():
    """Degrees by which light from the camera is turned on its way to the world, in the XY plane.

    The world shows (x, y, z) as colours times what the faces let through; z is 0, so green over red and blue tells
    the direction.
    """
    picture = render(samples=16)
    red, green, blue = picture.reshape(-1, 3).mean(axis=0)
    return np.degrees(np.arctan2(1.0 - red / blue, green / blue - 1.0))


def prism_scene():
    dispersing_scene(8)
    set_direction_world()
    add_camera((0.03, -4.0, 0.02), (0.03, 0.0, 0.02), width=0.5)


CLEAR = {"specular_scale": 0.0, "internal_reflections": False}


@pytest.mark.parametrize("wavelength", (440.0, 550.0, 660.0))
def test_a_prism_turns_each_wavelength_as_snell_has_it(tmp_path, wavelength):
    expected = np.degrees(np.arcsin(index(SF11, wavelength) * np.sin(np.radians(APEX)))) - APEX
    prism_scene()
    prism(material(SF11, spectral_distribution=line(tmp_path, wavelength), **CLEAR))
    assert deviation() == pytest.approx(expected, abs=0.01)


NEIGHBOURS = {
    "Sellmeier": WATER | {"dispersion_model": "SELLMEIER"},
    "Abbe": {"ior": 1.4, "dispersion_model": "ABBE", "abbe": 20.0},
    "JF": {"ior": 1.4, "dispersion_model": "JF", "dispersion": 0.1},
}


@pytest.mark.parametrize("name", NEIGHBOURS)
def test_a_medium_that_splits_no_light_bends_split_light_by_its_own_curve(tmp_path, name):
    keywords = {key: value for key, value in NEIGHBOURS[name].items() if key != "priority"}
    n1, n2 = index(SF11, 440.0), dispersion.material_ior(keywords, 440.0)
    assert abs(n2 - dispersion.material_ior(keywords, dispersion.LINE_D)) > 5e-3
    in_bath = np.arcsin(n1 / n2 * np.sin(np.radians(APEX))) - np.radians(APEX)
    prism_scene()
    prism(material(SF11, spectral_distribution=line(tmp_path, 440.0), **CLEAR), priority=1)
    bath = nd.new_material("Bath", shadow_mode="BLACK", **keywords, **CLEAR)
    add_box("Bath", (-3, -0.5, -2), (3, 3, 2), bath, priority=2)
    # 1e-5 of the index is 0.002 degrees here; single precision and the 0.02 nm of the line stay below it.
    assert deviation() == pytest.approx(np.degrees(np.arcsin(n2 * np.sin(in_bath))), abs=0.01)


def test_a_table_of_another_material_keeps_its_wavelengths_in_every_medium(tmp_path):
    n1, n2 = index(SF11, 445.0), index(WATER, 445.0)
    in_bath = np.arcsin(n1 / n2 * np.sin(np.radians(APEX))) - np.radians(APEX)
    prism_scene()
    bath = material(WATER, disperse=False, **CLEAR)
    for place, wavelength in enumerate((500.0, 600.0, 445.0)):
        glass = material(SF11, spectral_distribution=line(tmp_path, wavelength), **CLEAR)
        assert glass.node_tree.nodes["Nested Dielectric"].inputs["Spectral Table"].default_value == place + 1
    prism(glass, priority=1)
    add_box("Bath", (-3, -0.5, -2), (3, 3, 2), bath, priority=2)
    assert deviation() == pytest.approx(np.degrees(np.arcsin(n2 * np.sin(in_bath))), abs=0.01)


def daylight(wavelengths, gamut):
    """RGB of daylight's power at some wavelengths in a gamut, from colour-science's own tables."""
    matching = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    power = colour.SDS_ILLUMINANTS["D65"]
    xyz = np.stack([np.interp(wavelengths, matching.wavelengths, values) for values in matching.values.T], axis=-1)
    xyz *= np.interp(wavelengths, power.wavelengths, power.values)[:, None]
    space = colour.RGB_COLOURSPACES[gamut]
    white = np.array([0.95047, 1.0, 1.08883])
    target = colour.xy_to_XYZ(space.whitepoint)
    adapt = colour.adaptation.matrix_chromatic_adaptation_VonKries(white, target, "Bradford")
    return xyz @ adapt.T @ np.linalg.inv(space.matrix_RGB_to_XYZ).T


def add_attribute_glass(name, radius):
    """A sphere of Cycles' own Glass whose index is the object's property "index"."""
    mat = cycles_glass(1.0)
    attribute = mat.node_tree.nodes.new("ShaderNodeAttribute")
    attribute.attribute_type = "OBJECT"
    attribute.attribute_name = "index"
    glass = next(node for node in mat.node_tree.nodes if node.type == "BSDF_GLASS")
    mat.node_tree.links.new(attribute.outputs["Fac"], glass.inputs["IOR"])
    return add_sphere(name, radius, mat)


def brute_force(shells, gamut, count, samples, wavelengths=48):
    """Batches of pictures put together from renders of one wavelength each, with interfaces split by hand.

    Every batch has its own wavelengths, evenly spaced; together they are count times as many.
    """
    scene = bpy.context.scene
    objects = [add_attribute_glass(f"Shell {place}", radius) for place, (radius, _) in enumerate(shells)]
    scene.render.use_persistent_data = True
    # Cycles sends its first sample through the middle of every pixel, which weighs too much where there are few.
    scene.cycles.use_sample_subset = True
    scene.cycles.sample_offset = 16
    scene.cycles.sample_subset_length = samples
    return reference_tiles(
        lambda: wavelength_batches(objects, shells, gamut, count, samples, wavelengths),
        *(shells, gamut, count, samples, wavelengths),
        *map(inspect.getsource, (wavelength_batches, daylight, index)),
    )


def wavelength_batches(objects, shells, gamut, count, samples, wavelengths):
    pictures = []
    for batch in range(count):
        nm = 380.0 + 400.0 * (np.arange(wavelengths) + (batch + 0.5) / count) / wavelengths
        weights = daylight(nm, gamut)
        weights /= weights.sum(axis=0)
        picture = 0.0
        for place, wavelength in enumerate(nm):
            outside = 1.0
            for obj, (_, medium) in zip(objects, shells):
                obj["index"] = index(medium, wavelength) / outside
                obj.update_tag()
                outside = index(medium, wavelength)
            picture = picture + render(16 + samples, seed=1000 * batch + place) * weights[place]
        pictures.append(picture)
    return np.stack(pictures)


SHELLS = {"sphere": ((1.0, SF11),), "water in a sphere": ((1.0, SF11), (0.7, WATER))}


def look_at_shells():
    set_band_world()
    add_camera((0, -5, 0.3), (0, 0, 0), width=2.1)


def split_light(name, gamut, samples):
    """Batches of a picture of shells in which the outermost starts dispersion, with negative colours."""
    dispersing_scene()
    look_at_shells()
    for place, (radius, medium) in enumerate(SHELLS[name]):
        mat = material(medium, spectral_gamut=gamut, clamp_negative=False, disperse=place == 0)
        add_sphere(f"Shell {place}", radius, mat, priority=9 - place)
    return batches(8 * samples, 8)


@pytest.fixture(scope="module")
def wide_sphere():
    return split_light("sphere", "REC2020", 256)


@pytest.mark.parametrize("name", SHELLS)
def test_colours_are_those_of_one_render_for_every_wavelength(name, request):
    ours = request.getfixturevalue("wide_sphere") if name == "sphere" else split_light(name, "REC2020", 192)
    new_scene(48)
    look_at_shells()
    reference = brute_force(SHELLS[name], "ITU-R BT.2020", count=4, samples=16)
    assert_same_colours(ours, reference)


def assert_same_colours(ours, reference):
    """No tile differs by more than 4 standard errors, and no channel of the whole by more than 0.2 % beyond 2
    standard errors.
    """
    assert_same_picture(ours, reference, mean=5e-3)
    a, b = ours.mean(axis=(1, 2)), reference.mean(axis=(1, 2))
    error = np.sqrt(a.var(axis=0, ddof=1) / len(a) + b.var(axis=0, ddof=1) / len(b))
    relative = np.abs(a.mean(axis=0) - b.mean(axis=0)) - 2.0 * error
    assert (relative / b.mean(axis=0)).max() < 2e-3, (a.mean(axis=0) / b.mean(axis=0) - 1.0, error)


@pytest.mark.again
def test_a_wide_gamut_render_is_the_narrow_one_converted_where_nothing_is_clamped(wide_sphere):
    narrow, wide = (colour.RGB_COLOURSPACES[name] for name in ("ITU-R BT.709", "ITU-R BT.2020"))
    convert = colour.matrix_RGB_to_RGB(narrow, wide, None)
    assert_same_colours(split_light("sphere", "REC709", 256) @ convert.T, wide_sphere)


@pytest.mark.parametrize("roughness", (0.0, 0.3))
def test_a_white_world_seen_through_a_dispersing_object_is_white(roughness):
    dispersing_scene()
    set_world()
    add_camera((0, -5, 0.3), (0, 0, 0), width=2.1)
    add_sphere("Sphere", 1.0, material(SF11, roughness=roughness, distribution="GGX"))
    add_sphere("Drop", 0.6, material(WATER), priority=1)
    mean = render(samples=256).mean(axis=(0, 1))
    # Single-scattering GGX loses energy on rough surfaces, in all colours alike.
    mean = mean / mean.mean() if roughness else mean
    assert mean == pytest.approx([1.0, 1.0, 1.0], abs=2e-3)


def test_light_that_a_translucent_sheet_scatters_into_a_dispersing_object_stays_white():
    scene = dispersing_scene(16)
    set_world()
    add_camera((0, -8, 0), (0, 0, 0), width=0.5)
    sheet = native("Sheet", "ShaderNodeBsdfTranslucent", Color=(1.0, 1.0, 1.0, 1.0))
    add_plane("Sheet", 2, (0, 0, 0), (0, -1, 0), sheet)
    add_sphere("Ball", 1.0, material(SF11), location=(0, 1.2, 0))
    scene.cycles.diffuse_bounces = 1
    mean = render(samples=256).mean(axis=(0, 1))
    # 65,536 paths, whose colours deviate by 1.5 around white, leave 0.6 %.
    assert mean == pytest.approx([1.0, 1.0, 1.0], rel=0.02)


def test_what_is_not_seen_through_a_dispersing_object_does_not_change_in_a_single_pixel():
    dispersing_scene(32)
    set_band_world()
    add_camera((0, -8, 0), (0, 0, 0), width=5)
    add_plane("Wall", 20, (0, 0, 0), (1, 0, 0), diffuse(0.0))
    add_sphere("Plain", 1.0, nd.new_material("Plain", ior=1.5, shadow_mode="BLACK"), location=(-1.25, 0, 0))
    add_sphere("Chalk", 0.4, diffuse(0.8), location=(-1.25, 0, 1.6))
    glass = material(SF11, disperse=False)
    add_sphere("Prism", 1.0, glass, location=(1.25, 0, 0))
    without = render(samples=16)
    glass.node_tree.nodes["Nested Dielectric"].inputs["Disperse"].default_value = True
    split = render(samples=16)
    assert np.array_equal(split[:, :15], without[:, :15])
    assert not np.array_equal(split[:, 17:], without[:, 17:])


CLOSURES_DISPERSE = compatibility.shows_front_ior()
"""Whether Cycles' own closures may split light where paths carry no time."""


def without_time(**keywords):
    new_scene()
    set_band_world()
    add_camera((0, -5, 0.3), (0, 0, 0), width=2.1)
    add_sphere("Sphere", 1.0, material(SF11, **keywords))
    return render(samples=16)


JF_CURVE = {
    "dispersion_model": "JF",
    "ior": SF11["ior"] - dispersion.jf_ior(0.0, 0.2, dispersion.LINE_D),
    "dispersion": 0.2,
}


@pytest.mark.skipif(CLOSURES_DISPERSE, reason="Cycles' closures disperse")
def test_without_time_the_picture_is_that_of_the_d_line():
    split = without_time()
    assert np.array_equal(split, without_time(disperse=False))
    assert np.allclose(split, without_time(**JF_CURVE), atol=1e-3)


@pytest.mark.skipif(not CLOSURES_DISPERSE, reason="Cycles' closures do not disperse")
def test_without_time_light_is_split_by_cycles_and_only_where_it_is_asked_for():
    without = without_time(disperse=False)
    assert np.ptp(without, axis=2).max() < 1e-6
    assert np.ptp(without_time(), axis=2).mean() > 0.05 * without.mean()
    # JF's quadratic curve is not Cauchy's, so only the mean is near: the index at the d line and the spread agree.
    assert without_time(**JF_CURVE).mean() == pytest.approx(without.mean(), rel=0.02)


def cycles_dispersing_glass(ior, abbe):
    """Cycles' own dispersion: Principled, all transmission."""
    return native(
        "Principled",
        "ShaderNodeBsdfPrincipled",
        **{"Base Color": (1.0, 1.0, 1.0, 1.0), "Roughness": 0.0, "IOR": ior, "Transmission Weight": 1.0},
        **{"Transmission Dispersion Scale": 1.0, "Transmission Dispersion Abbe Number": abbe},
    )


@pytest.mark.skipif(not CLOSURES_DISPERSE, reason="Cycles' closures do not disperse")
@pytest.mark.parametrize("ior, abbe", [(1.5, 20.0), (0.75, 20.0)])
def test_without_time_an_object_disperses_as_cycles_own_glass(ior, abbe):
    pictures = []
    for make in (
        lambda: nd.new_material("Glass", ior=ior, abbe=abbe, disperse=True, shadow_mode="BLACK"),
        lambda: cycles_dispersing_glass(ior, abbe),
    ):
        new_scene()
        set_band_world()
        add_camera((0, -5, 0.3), (0, 0, 0), width=2.1)
        add_sphere("Sphere", 1.0, make())
        pictures.append(render(samples=64))
    # The same closures and random numbers: only where rounding turns a path may a pixel differ.
    assert (np.abs(pictures[0] - pictures[1]).max(axis=2) > 1e-3).mean() < 0.01
    assert np.ptp(pictures[0], axis=2).mean() > 0.05 * pictures[0].mean()


NESTED_CURVES = {
    "both disperse": ({"ior": 1.5, "abbe": 20.0}, {"ior": 1.33, "abbe": 30.0}),
    "the outer one disperses": ({"ior": 1.5, "abbe": 20.0}, {"ior": 1.33, "abbe": 0.0, "disperse": False}),
    "the outer one spreads wider": ({"ior": 1.5, "abbe": 20.0}, {"ior": 1.8, "abbe": 200.0}),
    "equal at the d line": ({"ior": 1.5, "abbe": 15.0}, {"ior": 1.5, "abbe": 150.0}),
}


@pytest.mark.skipif(not CLOSURES_DISPERSE, reason="Cycles' closures do not disperse")
@pytest.mark.parametrize("name", NESTED_CURVES)
def test_without_time_nested_media_show_the_colours_of_daylight_tables(name):
    """Cycles' closures split D65 unclamped, and its Cauchy curve of a ratio of indices is near that ratio's own."""
    pictures = []
    for blurred in (False, True):
        new_scene(48).render.use_motion_blur = blurred
        bpy.context.scene.render.motion_blur_shutter = 0.0
        set_band_world()
        add_camera((0, -5, 0.3), (0, 0, 0), width=2.1)
        for radius, priority, keywords in zip((1.0, 0.7), (2, 1), NESTED_CURVES[name]):
            light = {"disperse": True, "spectral_distribution": "D65", "clamp_negative": False, "shadow_mode": "BLACK"}
            add_sphere(f"Ball {priority}", radius, nd.new_material("M", **(light | keywords)), priority)
        pictures.append(batches(256, 8))
    # Of 589,824 paths with a deviation of 0.5 the mean is known to 1e-3 of itself; curves of these Abbe numbers, half of the
    # strongest glass's, leave the ratio's own by 1e-3 at the ends of the spectrum.
    assert_same_picture(*pictures, errors=5.0, mean=6e-3)
    assert np.ptp(pictures[0].mean(axis=0), axis=2).max() > 0.05


def test_motion_blur_is_followed_from_render_to_render_where_shaders_are_kept():
    scene = dispersing_scene(32)
    scene.render.use_persistent_data = True
    set_band_world()
    add_camera((0, -5, 0.3), (0, 0, 0), width=2.1)
    add_sphere("Sphere", 1.0, material(SF11))
    pictures = []
    for blurred in (False, True, False):
        scene.render.use_motion_blur = blurred
        pictures.append(render(samples=64))
    scene.render.use_persistent_data = False
    colourfulness = [np.ptp(picture, axis=2).mean() / picture.mean() for picture in pictures]
    assert 0.05 < colourfulness[1]
    assert CLOSURES_DISPERSE or colourfulness[0] < 1e-6
    assert np.array_equal(pictures[0], pictures[2]) and not np.array_equal(pictures[0], pictures[1])


def test_one_wavelength_is_reflected_totally_where_another_leaves(tmp_path):
    angle = np.radians(33.7)
    blue, red = index(SF11, 440.0), index(SF11, 660.0)
    assert blue * np.sin(angle) > 1.0 > red * np.sin(angle)
    dispersing_scene(8).cycles.max_bounces = 4  # blue light, which never leaves, is given up early
    set_half_world(2, 1)
    direction = np.array([np.sin(angle), 0.0, np.cos(angle)])
    add_camera(tuple(-0.5 * direction), tuple(0.5 * direction), width=0.1)
    glass = material(SF11, spectral_distribution=line(tmp_path, 440.0, 660.0), internal_reflections=False)
    add_box("Block", (-20, -20, -1), (20, 20, 1), glass)
    table = material_table(glass)
    share = table[table[:, 3] > 550.0, :3].sum(axis=0) / len(table)
    picture = render(samples=4096).mean(axis=(0, 1))
    # The share of red light among 64 pixels of 4096 well distributed wavelengths is off by less than 1 in 4096.
    assert picture == pytest.approx(share * (1.0 - fresnel(33.7, red, 1.0)), abs=2e-3)


def test_negative_colours_reach_the_image_unless_they_are_clamped():
    lowest = {}
    for clamped in (True, False):
        dispersing_scene()
        set_band_world()
        add_camera((0, -5, 0.3), (0, 0, 0), width=2.1)
        add_sphere("Sphere", 1.0, material(SF11, clamp_negative=clamped))
        lowest[clamped] = render(samples=256).min()
    assert lowest[True] >= 0.0 > -0.01 > lowest[False]


def test_motion_and_colour_do_not_correlate():
    scene = dispersing_scene(32)
    scene.render.motion_blur_shutter = 1.0
    set_world((0.0, 0.0, 0.0))
    add_camera((0, -5, 0), (0, 0, 0), width=2)
    add_box("Pane", (-2, -1, -2), (2, -0.8, 2), material(SF11))
    stripe = add_plane("Stripe", 0.4, (0, 0, 0), (0, -1, 0), emission())
    for frame, x in ((0, -1.0), (2, 1.0)):
        stripe.location.x = x
        stripe.keyframe_insert("location", frame=frame)
    scene.frame_set(1)
    picture = render(samples=1024)
    # Light that meets the pane straight on is not parted in space, so the stripe's trail is white along its whole
    # length. A pixel sees it for a fifth of the time, which leaves 1.2 / sqrt(1024 / 5) = 0.08 of noise in a channel,
    # and a column of the stripe's 6 pixels 0.03.
    trail = picture[13:19].mean(axis=0)
    trail = trail[trail.mean(axis=1) > 0.1]
    assert len(trail) > 12
    assert np.abs(trail / trail.mean(axis=1, keepdims=True) - 1.0).max() < 0.15


def caustic(mat, walks, samples):
    """What a ball throws on a floor out of a point light: the tile around the focus."""
    scene = bpy.context.scene
    set_world((0.0, 0.0, 0.0))
    add_camera((0.9, 0, 6), (0.9, 0, 0), width=1.6)
    floor = add_plane("Floor", 6, (0, 0, -1.2), (0, 0, 1), diffuse(0.8))
    ball = add_sphere("Ball", 0.5, mat, location=(0, 0, -0.4))
    light = bpy.data.lights.new("Light", "POINT")
    light.energy = 100
    light.shadow_soft_size = 0.02
    lamp = bpy.data.objects.new("Light", light)
    lamp.location = (-4, 0, 2.2)
    scene.collection.objects.link(lamp)
    if walks:
        ball.cycles.is_caustics_caster = floor.cycles.is_caustics_receiver = light.cycles.is_caustics_light = True
    return render(samples)[16:32, 16:32].mean(axis=(0, 1))


def test_shadow_caustics_are_split_into_the_colours_of_one_caustic_for_every_wavelength():
    dispersing_scene()
    ours = caustic(material(SF11), True, 64)
    table = material_table(material(SF11))
    reference = np.zeros(3)
    for part in np.array_split(table.astype(float), 12):
        new_scene(48)
        wavelength = part[:, 3].mean()
        reference += caustic(cycles_glass(index(SF11, wavelength)), True, 16) * part[:, :3].sum(axis=0) / len(table)
    assert reference.max() / reference.min() > 1.04
    # 12 wavelengths and 4,096 paths a render leave less than 0.5 %.
    assert ours == pytest.approx(reference, rel=1e-2)
    dispersing_scene()
    assert caustic(material(SF11), False, 64).max() < 0.5 * ours.min()
