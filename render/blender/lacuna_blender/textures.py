"""Images of materials as textures of the .glb."""

import os
import struct
import zlib
from dataclasses import dataclass, replace

import numpy

REPEAT, CLAMP, MIRROR = 10497, 33071, 33648
NEAREST, LINEAR = 9728, 9729
_WRAPS = {"REPEAT": REPEAT, "EXTEND": CLAMP, "CLIP": CLAMP, "MIRROR": MIRROR}


class Picture:
    """Computed texels that are no image of Blender: height x width x 3, linear, row 0 at the top."""

    source = "GENERATED"

    def __init__(self, name, rgb):
        self.name = name
        self.texels = numpy.concatenate([rgb, numpy.ones_like(rgb[..., :1])], axis=-1)


@dataclass(frozen=True)
class Use:
    """An image on a surface. `place`: offset, rotation and scale of KHR_texture_transform, or None."""

    image: object  # bpy.types.Image or Picture
    uv_map: str = ""  # "": the one active for rendering
    place: tuple = None
    wrap: str = "REPEAT"
    nearest: bool = False  # no interpolation
    channel: str = ""  # for scalars: R, G, B or A, "" for the luminance
    size: float = 0.0  # side of its square on the surface in metres; 0: that of the mesh's UV map


def placed_alike(uses):
    """Whether images are placed alike on a surface, so that their texels may be mixed."""
    return len({replace(use, image=None, channel="") for use in uses}) < 2


def png(texels):
    """A PNG file. `texels`: height x width x 3 or 4 bytes, row 0 at the top."""
    height, width, depth = texels.shape

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = numpy.zeros((height, 1 + width * depth), numpy.uint8)
    rows[:, 1:] = texels.reshape(height, -1)
    head = struct.pack(">IIBBBBB", width, height, 8, 6 if depth == 4 else 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows.tobytes(), 3)) + chunk(b"IEND", b"")


def to_srgb(linear):
    linear = numpy.clip(linear, 0, 1)
    return numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def to_linear(coded):
    return numpy.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)


def stored(image):
    """The image's stored values, height x width x 4 floats, row 0 at the top."""
    if isinstance(image, Picture):
        return image.texels
    width, height = image.size
    values = numpy.empty(width * height * 4, numpy.float32)
    image.pixels.foreach_get(values)
    return values.reshape(height, width, 4)[::-1]


def is_coded(image):
    """Whether the image's colours are coded as sRGB. Those of float images in Blender are linear."""
    return not isinstance(image, Picture) and not image.is_float and \
        image.colorspace_settings.name not in ("Non-Color", "Raw", "Linear", "Linear Rec.709")


def linear(image):
    values = stored(image)
    if is_coded(image):
        values = numpy.concatenate([to_linear(values[..., :3]), values[..., 3:]], axis=-1)
    return values


def scalar(use):
    values = linear(use.image)
    if use.channel:
        return values[..., "RGBA".index(use.channel)]
    return values[..., :3] @ numpy.array([0.2126, 0.7152, 0.0722], numpy.float32)


def resized(values, shape):
    """Values resampled to `shape` by nearest texels."""
    rows = numpy.arange(shape[0]) * values.shape[0] // shape[0]
    columns = numpy.arange(shape[1]) * values.shape[1] // shape[1]
    return values[rows][:, columns]


class Textures:
    """The textures of one document; each combination of images is written once."""

    def __init__(self, glb):
        self._glb, self._made = glb, {}

    def color(self, use, alpha=None):
        """Index of an sRGB texture, with the values of another image in alpha."""
        key = ("color", use.image.name, use.wrap, use.nearest, alpha and (alpha.image.name, alpha.channel))
        if key not in self._made:
            data = None if alpha else _file_of(use.image)
            self._made[key] = self._add(use, *(data or (self._coded(use, alpha), "image/png")))
        return self._made[key]

    def scalars(self, **channels):
        """Index of a linear texture. `channels`: R, G, B or A, each a Use or None; channels without a Use are 1."""
        first = next(use for use in channels.values() if use)
        key = tuple((c, u and (u.image.name, u.channel, u.wrap, u.nearest)) for c, u in sorted(channels.items()))
        if key not in self._made:
            planes = {c: scalar(u) for c, u in channels.items() if u}
            shape = max((p.shape for p in planes.values()), key=lambda s: s[0] * s[1])
            texels = numpy.ones((*shape, 4), numpy.float32)
            for c, plane in planes.items():
                texels[..., "RGBA".index(c)] = resized(plane, shape)
            self._made[key] = self._add(first, png(_bytes(texels)), "image/png")
        return self._made[key]

    def normals(self, use):
        key = ("normals", use.image.name, use.wrap, use.nearest)
        if key not in self._made:
            self._made[key] = self._add(use, png(_bytes(stored(use.image)[..., :3])), "image/png")
        return self._made[key]

    def info(self, texture, use, uv_set):
        """A material's reference to a texture."""
        info = {"index": texture}
        if uv_set:
            info["texCoord"] = uv_set
        if use.place:
            offset, rotation, scale = use.place
            self._glb.extension(info, "KHR_texture_transform",
                                {"offset": list(offset), "rotation": rotation, "scale": list(scale)})
        return info

    def _coded(self, use, alpha):
        image = use.image
        values = stored(image) if is_coded(image) else linear(image)
        coded = values[..., :3] if is_coded(image) else to_srgb(values[..., :3])
        coverage = values[..., 3] if alpha is None or (alpha.image == image and alpha.channel == "A") \
            else resized(scalar(alpha), values.shape)
        return png(_bytes(numpy.dstack([coded, coverage if alpha else numpy.ones_like(coverage)])))

    def _add(self, use, data, mime):
        wrap = _WRAPS.get(use.wrap, REPEAT)
        sampler = self._glb.append("samplers", {"wrapS": wrap, "wrapT": wrap, "magFilter": NEAREST if use.nearest else LINEAR})
        source = self._glb.image(data, mime, use.image.name)
        return self._glb.append("textures", {"sampler": sampler, "source": source})


def _bytes(values):
    return (numpy.clip(values, 0, 1) * 255 + 0.5).astype(numpy.uint8)


def _file_of(image):
    """The bytes and type of the image's file if they can be used unchanged; else None."""
    if image.source != "FILE" or image.is_dirty or not is_coded(image) or image.file_format != "JPEG":
        return None  # a PNG may have an alpha channel, which an opaque surface must not have
    if image.packed_file:
        return image.packed_file.data, "image/jpeg"
    path = image.filepath_from_user()
    if not os.path.isfile(path):
        return None
    with open(path, "rb") as file:
        return file.read(), "image/jpeg"
