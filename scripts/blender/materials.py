# SPDX-License-Identifier: MIT
"""Materials of an exchange scene as nodes of Cycles, so that they scatter as ours do (datasets/glassroom/bsdf.h).

diffuse          Lambert, and emission where there is any, on both sides
conductor        GGX, F0 = albedo, with what single scattering loses given back: Principled, metallic, "Multiscatter GGX"
plastic          dielectric GGX coat, scattered once: Principled with a black base; below it Lambert, weighted by 1 - E(o),
                 the coat's own albedo. Ours has the factor (1 - E(i)) / (1 - E_mean) besides, whose mean over diffuse
                 light is 1
mirror           Glossy without roughness, the albedo its colour at any angle
thin dielectric  straight on or mirrored, by the reflectance of a thin slab; shadow rays go straight on
"""
import bpy

# Blender 3 bends a metal's reflectance from F0 to 1 as that of a dielectric, not by Schlick's fifth power. With this
# index the mean over diffuse light is Schlick's, 1/21 of the way.
SCHLICK_IOR = 1.35


class Nodes:
    """A material's nodes in the making; what is handed around are output sockets and numbers."""

    def __init__(self, material):
        material.use_nodes = True
        self.nodes, self.links = material.node_tree.nodes, material.node_tree.links
        self.nodes.clear()

    def add(self, kind, **inputs):
        node = self.nodes.new(kind)
        for name, value in inputs.items():
            self.put(node.inputs[name.replace("_", " ")], value)
        return node

    def put(self, socket, value):
        if isinstance(value, bpy.types.NodeSocket):
            self.links.new(value, socket)
        else:
            socket.default_value = value[:3] if socket.type == "VECTOR" else value

    def math(self, operation, *values):
        node = self.nodes.new("ShaderNodeMath")
        node.operation = operation
        for socket, value in zip(node.inputs, values):
            self.put(socket, value)
        return node.outputs[0]

    def cosine(self):
        """Of the direction that the ray came from, on either side."""
        geometry = self.nodes.new("ShaderNodeNewGeometry")
        dot = self.nodes.new("ShaderNodeVectorMath")
        dot.operation = "DOT_PRODUCT"
        self.links.new(geometry.outputs["Normal"], dot.inputs[0])
        self.links.new(geometry.outputs["Incoming"], dot.inputs[1])
        return self.math("MINIMUM", self.math("ABSOLUTE", dot.outputs["Value"]), 1.0)

    def mixed(self, share, first, second):
        node = self.nodes.new("ShaderNodeMixShader")
        for socket, value in zip(node.inputs, (share, first, second)):
            self.put(socket, value)
        return node.outputs[0]

    def sum(self, first, second):
        node = self.nodes.new("ShaderNodeAddShader")
        self.links.new(first, node.inputs[0])
        self.links.new(second, node.inputs[1])
        return node.outputs[0]

    def scaled(self, color, factor):
        """color * factor, channel by channel."""
        node = self.nodes.new("ShaderNodeVectorMath")
        node.operation = "MULTIPLY"
        for socket, value in zip(node.inputs, (color, factor)):
            self.put(socket, value)
        return node.outputs[0]


def rgba(color):
    return (*color, 1)


def albedo_color(nodes, spec, folder):
    """The texture times the albedo, or the albedo."""
    if "texture" not in spec:
        return rgba(spec["albedo"])
    node = nodes.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.load(str(folder / spec["texture"]), check_existing=True)
    node.image.colorspace_settings.name = "Non-Color"  # linear already
    node.image.use_half_precision = False
    node.interpolation, node.extension = "Linear", "REPEAT"
    return nodes.scaled(node.outputs["Color"], spec["albedo"])


def diffuse(nodes, color):
    return nodes.add("ShaderNodeBsdfDiffuse", Color=color, Roughness=0).outputs[0]


def principled(nodes, spec, distribution, ior, **inputs):
    node = nodes.add("ShaderNodeBsdfPrincipled", Roughness=spec["roughness"], **inputs)
    node.distribution = distribution
    if "Specular IOR Level" in node.inputs:  # Blender 4
        node.inputs["IOR"].default_value = ior
    else:
        node.inputs["Specular"].default_value = ((ior - 1) / (ior + 1)) ** 2 / 0.08
    return node.outputs[0]


def conductor(nodes, spec, color):
    return principled(nodes, spec, "MULTI_GGX", SCHLICK_IOR, Base_Color=color, Metallic=1)


def base_share(nodes, coat_albedo):
    """1 - E at the ray's cosine; the table's steps are even in the cosine's root."""
    node = nodes.nodes.new("ShaderNodeValToRGB")
    stops = node.color_ramp.elements
    while len(stops) < len(coat_albedo):
        stops.new(0.5)
    for i, albedo in enumerate(coat_albedo):
        stops[i].position = i / (len(coat_albedo) - 1)
        stops[i].color = rgba([1 - albedo] * 3)
    nodes.put(node.inputs["Fac"], nodes.math("SQRT", nodes.cosine()))
    return node.outputs["Color"]


def plastic(nodes, spec, color):
    base = diffuse(nodes, nodes.scaled(color, base_share(nodes, spec["coat_albedo"])))
    coat = principled(nodes, spec, "GGX", spec["ior"], Base_Color=rgba((0, 0, 0)))
    return nodes.sum(coat, base)


def slab_reflectance(nodes, ior):
    """All orders between the faces, mean of both polarisations: 2r / (1 + r) each, r by Fresnel."""
    cos_i = nodes.cosine()
    sin2_t = nodes.math("DIVIDE", nodes.math("SUBTRACT", 1.0, nodes.math("MULTIPLY", cos_i, cos_i)), ior * ior)
    cos_t = nodes.math("SQRT", nodes.math("SUBTRACT", 1.0, sin2_t))
    halves = []
    for a, b in ((cos_i, nodes.math("MULTIPLY", cos_t, ior)), (nodes.math("MULTIPLY", cos_i, ior), cos_t)):
        root = nodes.math("DIVIDE", nodes.math("SUBTRACT", a, b), nodes.math("ADD", a, b))
        r = nodes.math("MULTIPLY", root, root)
        halves.append(nodes.math("DIVIDE", r, nodes.math("ADD", 1.0, r)))
    return nodes.math("ADD", *halves)


def mirror(nodes, color):
    return nodes.add("ShaderNodeBsdfGlossy", Color=color, Roughness=0).outputs[0]


def thin_dielectric(nodes, spec):
    through = nodes.add("ShaderNodeBsdfTransparent", Color=rgba(spec["tint"])).outputs[0]
    return nodes.mixed(slab_reflectance(nodes, spec["ior"]), through, mirror(nodes, rgba((1, 1, 1))))


def surface(nodes, spec, folder):
    if spec["kind"] == "thin dielectric":
        return thin_dielectric(nodes, spec)
    color = albedo_color(nodes, spec, folder)
    if spec["kind"] in ("diffuse", "mirror"):
        return {"diffuse": diffuse, "mirror": mirror}[spec["kind"]](nodes, color)
    return {"conductor": conductor, "plastic": plastic}[spec["kind"]](nodes, spec, color)


def build(spec, folder):
    """Of the material that is called spec["id"], if any mesh has it."""
    material = bpy.data.materials.get(spec["id"])
    if material is None:
        return
    nodes = Nodes(material)
    shader = surface(nodes, spec, folder)
    strength = max(spec["emission"])
    if strength > 0:
        color = rgba([value / strength for value in spec["emission"]])
        light = nodes.add("ShaderNodeEmission", Color=color, Strength=strength)
        shader = nodes.sum(shader, light.outputs[0])
    output = nodes.nodes.new("ShaderNodeOutputMaterial")
    nodes.links.new(shader, output.inputs["Surface"])
    material.pass_index = 1 if spec["kind"] == "thin dielectric" else 0
