"""Textures of pictures."""

from panda3d.core import SamplerState, Texture

from mocapd.types import Bytes


def texture_of(name: str, picture: Bytes, tiles: bool = False, smooth: bool = False) -> Texture:
    """A texture of a picture (h,w,4) uint8 RGBA, row 0 on top. smooth: also where a pixel of it is larger than one of
    the screen, which the software renderer pays for."""
    height, width, _ = picture.shape
    texture = Texture(name)
    texture.setup2dTexture(width, height, Texture.TUnsignedByte, Texture.FRgba)
    texture.setRamImageAs(picture[::-1].tobytes(), "RGBA")
    texture.setMinfilter(SamplerState.FT_linear_mipmap_nearest)
    texture.setMagfilter(SamplerState.FT_linear if smooth else SamplerState.FT_nearest)
    wrap = SamplerState.WM_repeat if tiles else SamplerState.WM_clamp
    texture.setWrapU(wrap)
    texture.setWrapV(wrap)
    return texture
