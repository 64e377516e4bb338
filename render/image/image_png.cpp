#include "base/noncopyable.h"
#include "render/image/image_codecs.h"

#include <png.h>

#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstring>
#include <new>

namespace gs::render {
namespace {

constexpr std::size_t kSizeEnd = 24;  // bytes of the signature, length and name of IHDR, width and height

/// State that the callbacks of libpng share. libpng leaves functions by longjmp. So this object or the caller owns all
/// resources, and functions with setjmp have only trivial local variables.
struct PngReader : NonCopyable {
  std::span<const std::byte> bytes;
  std::size_t position = 0;
  png_structp png = nullptr;
  png_infop info = nullptr;
  char message[160] = "unknown error";
  std::uint32_t width = 0, height = 0;
  std::uint32_t channels = 0;  // components in the rows of libpng
  std::uint32_t components = 0;  // components of the result
  int passes = 1;
  std::uint32_t reduction = 1;
  bool interlaced = false;
  std::uint8_t* first_row = nullptr;
  std::uint8_t* pixels = nullptr;  // rows with `channels` bytes per pixel
  RowReducer* reducer = nullptr;   // receives the rows if the image must be reduced
  const ImageLimits* limits = nullptr;

  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
};

void on_read_error(png_structp png, png_const_charp text) {
  auto* reader = static_cast<PngReader*>(png_get_error_ptr(png));
  std::snprintf(reader->message, sizeof reader->message, "%s", text);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void read_bytes(png_structp png, png_bytep to, png_size_t count) {
  auto* reader = static_cast<PngReader*>(png_get_io_ptr(png));
  if (count > reader->bytes.size() - reader->position) {
    reader->position = reader->bytes.size();
    png_error(png, "the data is truncated");
  }
  std::memcpy(to, reader->bytes.data() + reader->position, count);
  reader->position += count;
}

/// Reports whether a palette has only greys. The image is then an intensity texture (VRML97 4.6.11.2).
bool palette_is_grey(png_structp png, png_infop info) {
  png_colorp palette = nullptr;
  int count = 0;
  if (!png_get_PLTE(png, info, &palette, &count)) return false;
  for (int i = 0; i < count; ++i)
    if (palette[i].red != palette[i].green || palette[i].green != palette[i].blue) return false;
  return true;
}

bool read_header(PngReader& reader) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_set_read_fn(reader.png, &reader, read_bytes);
  // Skip unused profiles and comments. This saves time and reduces the attack surface.
  static const png_byte kSkipped[] = "iCCP\0iTXt\0tEXt\0zTXt\0sPLT\0eXIf";
  png_set_keep_unknown_chunks(reader.png, PNG_HANDLE_CHUNK_NEVER, kSkipped, 6);
  png_read_info(reader.png, reader.info);
  reader.width = png_get_image_width(reader.png, reader.info);
  reader.height = png_get_image_height(reader.png, reader.info);
  const int color_type = png_get_color_type(reader.png, reader.info);
  const bool transparent = png_get_valid(reader.png, reader.info, PNG_INFO_tRNS) != 0;
  const bool grey_palette = color_type == PNG_COLOR_TYPE_PALETTE && palette_is_grey(reader.png, reader.info);
  if (color_type == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(reader.png);
  if (color_type == PNG_COLOR_TYPE_GRAY) png_set_expand_gray_1_2_4_to_8(reader.png);
  if (transparent) png_set_tRNS_to_alpha(reader.png);
  png_set_scale_16(reader.png);
  reader.reduction = reduction_of(reader.width, reader.height, *reader.limits);
  reader.interlaced = png_get_interlace_type(reader.png, reader.info) != PNG_INTERLACE_NONE;
  // If a large image is interlaced, its first passes are a smaller image, so interlace handling stays off.
  if (reader.reduction == 1) reader.passes = png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  reader.channels = png_get_channels(reader.png, reader.info);
  reader.components = grey_palette ? reader.channels - 2 : reader.channels;
  if (png_get_rowbytes(reader.png, reader.info) != std::size_t{reader.width} * reader.channels)
    png_error(reader.png, "unexpected row size");
  return true;
}

bool stopped(const PngReader& reader) { return reader.limits->stopped && reader.limits->stopped(); }

/// Reads the first row before the image is allocated, so that a file without pixels allocates little.
bool read_first_row(PngReader& reader) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_read_row(reader.png, nullptr, reader.first_row);
  return true;
}

bool read_rows(PngReader& reader) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  const std::size_t stride = std::size_t{reader.width} * reader.channels;
  std::memcpy(reader.pixels, reader.first_row, stride);
  for (int pass = 0; pass < reader.passes; ++pass)
    for (std::uint32_t y = pass == 0 ? 1 : 0; y < reader.height && !stopped(reader); ++y)
      // Passes the row as the second buffer. There libpng writes whole blocks of an interlaced image, so that a
      // truncated image has no gaps.
      png_read_row(reader.png, nullptr, reader.pixels + y * stride);
  return true;
}

bool reduce_rows(PngReader& reader) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  for (std::uint32_t y = 0; y < reader.height && !stopped(reader); ++y) {
    if (y > 0) png_read_row(reader.png, reader.first_row, nullptr);
    reader.reducer->take(reader.first_row);
  }
  return true;
}

/// Reads the first passes of an interlaced image. They contain each 8th, 4th or 2nd pixel of each 8th, 4th or 2nd row.
bool thin_out_passes(PngReader& reader) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  const std::uint32_t step = reader.reduction, kept = (reader.width - 1) / step + 1;
  const int passes = step >= 8 ? 1 : step >= 4 ? 3 : 5;
  for (int pass = 0; pass < passes; ++pass) {
    const std::uint32_t columns = PNG_PASS_COLS(reader.width, pass), rows = PNG_PASS_ROWS(reader.height, pass);
    if (columns == 0) continue;
    for (std::uint32_t row = 0; row < rows && !stopped(reader); ++row) {
      if (pass > 0 || row > 0) png_read_row(reader.png, reader.first_row, nullptr);
      const std::uint32_t y = PNG_ROW_FROM_PASS_ROW(row, pass);
      for (std::uint32_t column = 0; y % step == 0 && column < columns; ++column) {
        const std::uint32_t x = PNG_COL_FROM_PASS_COL(column, pass);
        if (x % step == 0)
          std::memcpy(reader.pixels + (std::size_t{y / step} * kept + x / step) * reader.channels,
                      reader.first_row + std::size_t{column} * reader.channels, reader.channels);
      }
    }
  }
  return true;
}

/// Keeps only R (and A) of grey RGB(A) pixels, in place.
void keep_grey(std::vector<std::uint8_t>& pixels, std::uint32_t channels) {
  const std::uint32_t kept = channels - 2;
  std::size_t to = 0;
  for (std::size_t from = 0; from < pixels.size(); from += channels) {
    pixels[to++] = pixels[from];
    if (kept == 2) pixels[to++] = pixels[from + 3];
  }
  pixels.resize(to);
}

ImageError png_error_of(const PngReader& reader) {
  return {std::string("broken PNG: ") + reader.message + " (at byte " + std::to_string(reader.position) + ")"};
}

}  // namespace

DecodedImage decode_png(std::span<const std::byte> bytes, const ImageLimits& limits) {
  if (bytes.size() < kSizeEnd) return ImageError{"broken PNG: the data ends before the size of the picture"};
  const auto* header = reinterpret_cast<png_const_bytep>(bytes.data());
  if (auto refused = refuse_size("PNG", png_get_uint_32(header + 16), png_get_uint_32(header + 20), limits))
    return *std::move(refused);

  PngReader reader;
  reader.bytes = bytes;
  reader.limits = &limits;
  reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, on_read_error, on_warning);
  if (!reader.png) throw std::bad_alloc();
  reader.info = png_create_info_struct(reader.png);
  if (!reader.info) throw std::bad_alloc();

  if (!read_header(reader)) return png_error_of(reader);
  // Check the size again, as libpng reports it.
  if (auto refused = refuse_size("PNG", reader.width, reader.height, limits)) return *std::move(refused);
  std::vector<std::uint8_t> first_row(std::size_t{reader.width} * reader.channels);
  reader.first_row = first_row.data();
  if (!read_first_row(reader)) return png_error_of(reader);

  Image image;
  if (reader.reduction > 1 && reader.interlaced) reader.reduction = std::bit_ceil(reader.reduction);
  // Rows before an error or the end of a truncated file stay valid.
  RowReducer reducer(image, reader.width, reader.height, reader.channels, reader.reduction);
  reader.pixels = image.pixels.data();
  reader.reducer = &reducer;
  if (reader.reduction == 1)
    (void)read_rows(reader);
  else if (reader.interlaced)
    (void)thin_out_passes(reader);
  else
    (void)reduce_rows(reader);
  reducer.finish();
  image.components = reader.components;
  if (reader.components != reader.channels) keep_grey(image.pixels, reader.channels);
  return image;
}

}  // namespace gs::render
