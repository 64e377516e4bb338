#include "render/image/image_codecs.h"

#include <gif_lib.h>

#include <algorithm>
#include <array>
#include <cstring>

namespace gs::render {
namespace {

/// Bytes of a GIF file, for giflib. If they end inside the pixels, giflib gets a shorter last block and an end mark. It
/// then keeps every complete row.
struct GifSource {
  std::span<const std::byte> bytes;
  std::size_t position = 0;
  bool in_pixels = false;
  bool length_next = true;  // the next byte is the length of a sub-block, not part of its data

  [[nodiscard]] std::size_t left() const { return bytes.size() - position; }

  GifByteType block_length() {
    if (left() == 0) return 0;
    const auto length = static_cast<std::size_t>(bytes[position++]);
    const auto given = static_cast<GifByteType>(std::min(length, left()));
    length_next = given == 0;
    return given;
  }
};

int read_bytes(GifFileType* gif, GifByteType* to, int count) {
  auto* source = static_cast<GifSource*>(gif->UserData);
  if (source->in_pixels && source->length_next && count == 1) {
    *to = source->block_length();
    return 1;
  }
  source->length_next = true;
  const std::size_t given = std::min(source->left(), static_cast<std::size_t>(std::max(count, 0)));
  if (given > 0) std::memcpy(to, source->bytes.data() + source->position, given);
  source->position += given;
  return static_cast<int>(given);
}

struct GifCloser {
  void operator()(GifFileType* gif) const { DGifCloseFile(gif, nullptr); }
};
using Gif = std::unique_ptr<GifFileType, GifCloser>;

ImageError gif_error(int code) {
  const char* text = GifErrorString(code);
  return {std::string("broken GIF: ") + (text ? text : "the data is truncated")};
}

/// Reads blocks up to the first picture. Sets `transparent` to the index of the transparent colour, or to -1.
std::optional<ImageError> find_first_picture(GifFileType& gif, int& transparent) {
  transparent = NO_TRANSPARENT_COLOR;
  while (true) {
    GifRecordType type = UNDEFINED_RECORD_TYPE;
    if (DGifGetRecordType(&gif, &type) == GIF_ERROR) return gif_error(gif.Error);
    if (type == IMAGE_DESC_RECORD_TYPE) return std::nullopt;
    if (type != EXTENSION_RECORD_TYPE) return ImageError{"broken GIF: it has no picture; expected an image descriptor"};
    int code = 0;
    GifByteType* block = nullptr;
    if (DGifGetExtension(&gif, &code, &block) == GIF_ERROR) return gif_error(gif.Error);
    if (code == GRAPHICS_EXT_FUNC_CODE && block && block[0] >= 4) {
      GraphicsControlBlock control{};
      if (DGifExtensionToGCB(block[0], block + 1, &control) == GIF_OK) transparent = control.TransparentColor;
    }
    while (block)
      if (DGifGetExtensionNext(&gif, &block) == GIF_ERROR) return gif_error(gif.Error);
  }
}

/// Palette, converted to image components as for PNG (VRML97 4.6.11.2).
struct Palette {
  std::uint32_t components = 0;
  std::array<std::array<std::uint8_t, 4>, 256> entries{};  // indexes after the end of the table are black
};

Palette make_palette(const ColorMapObject& map, int transparent, bool needs_alpha) {
  Palette palette;
  const int count = std::clamp(map.ColorCount, 0, 256);
  bool grey = true;
  for (int i = 0; i < count; ++i) {
    const GifColorType& c = map.Colors[i];
    grey = grey && c.Red == c.Green && c.Green == c.Blue;
  }
  const std::uint32_t colors = grey ? 1 : 3;
  palette.components = colors + (needs_alpha ? 1 : 0);
  for (int i = 0; i < 256; ++i) {
    auto& entry = palette.entries[static_cast<std::size_t>(i)];
    if (i == transparent) continue;
    if (i < count) entry = {map.Colors[i].Red, map.Colors[i].Green, map.Colors[i].Blue, 0};
    if (needs_alpha) entry[colors] = 255;
  }
  return palette;
}

/// Writes a row of pixels. In a reduced image, one file pixel represents each square.
void put_row(Image& image, const GifImageDesc& frame, std::uint32_t y, const std::vector<GifPixelType>& line,
             const Palette& palette) {
  const std::uint32_t step = image.reduction, row = static_cast<std::uint32_t>(frame.Top) + y;
  if (row / step >= image.height || row % step != 0) return;
  for (std::size_t x = 0; x < line.size(); ++x) {
    const std::size_t column = static_cast<std::size_t>(frame.Left) + x;
    if (column / step >= image.width) return;
    if (column % step != 0) continue;
    std::memcpy(image.pixels.data() + (std::size_t{row / step} * image.width + column / step) * image.components,
                palette.entries[line[x]].data(), image.components);
  }
}

/// Returns the row number in the image of each row in the file.
std::vector<std::uint32_t> row_order(const GifImageDesc& frame) {
  const auto height = static_cast<std::uint32_t>(frame.Height);
  std::vector<std::uint32_t> rows;
  rows.reserve(height);
  constexpr std::array<std::array<std::uint32_t, 2>, 4> kPasses = {{{0, 8}, {4, 8}, {2, 4}, {1, 2}}};
  if (!frame.Interlace)
    for (std::uint32_t y = 0; y < height; ++y) rows.push_back(y);
  else
    for (const auto& [first, step] : kPasses)
      for (std::uint32_t y = first; y < height; y += step) rows.push_back(y);
  return rows;
}

}  // namespace

DecodedImage decode_gif(std::span<const std::byte> bytes, const ImageLimits& limits) {
  GifSource source{bytes};
  int code = 0;
  const Gif gif(DGifOpen(&source, read_bytes, &code));
  if (!gif) return gif_error(code);
  int transparent = NO_TRANSPARENT_COLOR;
  if (auto error = find_first_picture(*gif, transparent)) return *std::move(error);
  if (DGifGetImageDesc(gif.get()) == GIF_ERROR) return gif_error(gif->Error);

  const GifImageDesc& frame = gif->Image;
  const std::uint64_t width = gif->SWidth > 0 ? gif->SWidth : frame.Left + frame.Width;
  const std::uint64_t height = gif->SHeight > 0 ? gif->SHeight : frame.Top + frame.Height;
  if (auto refused = refuse_size("GIF", width, height, limits)) return *std::move(refused);
  if (auto refused = refuse_size("GIF", frame.Width, frame.Height, limits)) return *std::move(refused);
  const ColorMapObject* map = frame.ColorMap ? frame.ColorMap : gif->SColorMap;
  if (!map || !map->Colors) return ImageError{"broken GIF: no palette; expected a global or a local colour table"};

  // Pixels outside of the first picture are transparent, as in browsers.
  const bool covers = frame.Left == 0 && frame.Top == 0 && static_cast<std::uint64_t>(frame.Width) >= width &&
                      static_cast<std::uint64_t>(frame.Height) >= height;
  const Palette palette = make_palette(*map, transparent, transparent != NO_TRANSPARENT_COLOR || !covers);
  Image image;
  image.reduction = reduction_of(width, height, limits);
  image.width = (static_cast<std::uint32_t>(width) - 1) / image.reduction + 1;
  image.height = (static_cast<std::uint32_t>(height) - 1) / image.reduction + 1;
  image.components = palette.components;
  std::vector<GifPixelType> line(static_cast<std::size_t>(frame.Width));
  source.in_pixels = true;
  for (const std::uint32_t y : row_order(frame)) {
    if (DGifGetLine(gif.get(), line.data(), frame.Width) == GIF_ERROR) {
      if (image.pixels.empty()) return gif_error(gif->Error);
      break;
    }
    if (limits.stopped && limits.stopped()) break;
    if (image.pixels.empty()) image.pixels.resize(std::size_t{image.width} * image.height * image.components);
    put_row(image, frame, y, line, palette);
  }
  return image;
}

}  // namespace gs::render
