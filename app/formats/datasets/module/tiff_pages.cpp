#include "app/formats/datasets/module/tiff_pages.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <utility>

namespace gs::app {
namespace {

constexpr std::uint64_t kMostBlock = std::uint64_t{1} << 30;  // bytes of a strip or tile

std::uint16_t short_field(TIFF* tiff, std::uint32_t tag, std::uint16_t otherwise) {
  std::uint16_t value = otherwise;
  TIFFGetFieldDefaulted(tiff, tag, &value);
  return value;
}

NumberType number_type(std::uint16_t bits, std::uint16_t format) {
  if (format == SAMPLEFORMAT_IEEEFP || format == SAMPLEFORMAT_COMPLEXIEEEFP) {
    const unsigned each = format == SAMPLEFORMAT_COMPLEXIEEEFP ? bits / 2u : bits;
    return each == 16 || each == 24 || each == 32 ? NumberType::f32 : each == 64 ? NumberType::f64 : NumberType::none;
  }
  const bool is_signed = format == SAMPLEFORMAT_INT || format == SAMPLEFORMAT_COMPLEXINT;
  const unsigned each = format == SAMPLEFORMAT_COMPLEXINT ? bits / 2u : bits;
  if (each == 0 || each > 64 || (each > 8 && each % 4 != 0)) return NumberType::none;
  if (each <= 8) return is_signed ? NumberType::i8 : NumberType::u8;
  if (each <= 16) return is_signed ? NumberType::i16 : NumberType::u16;
  if (each <= 32) return is_signed ? NumberType::i32 : NumberType::u32;
  return each == 64 ? (is_signed ? NumberType::i64 : NumberType::u64) : NumberType::none;
}

float half_to_float(std::uint32_t half) {
  const float sign = (half & 0x8000) != 0 ? -1.0f : 1.0f;
  const int exponent = static_cast<int>(half >> 10 & 31);
  const auto fraction = static_cast<float>(half & 1023);
  if (exponent == 31) return fraction == 0 ? sign * INFINITY : NAN;
  return exponent == 0 ? sign * std::ldexp(fraction, -24) : sign * std::ldexp(1024 + fraction, exponent - 25);
}

// 1 bit of sign, 7 of exponent, 16 of fraction (TIFF technical note 3).
float float_of_24_bits(std::uint32_t value) {
  const float sign = (value & 0x800000) != 0 ? -1.0f : 1.0f;
  const int exponent = static_cast<int>(value >> 16 & 127);
  const auto fraction = static_cast<float>(value & 0xffff);
  if (exponent == 127) return fraction == 0 ? sign * INFINITY : NAN;
  return exponent == 0 ? sign * std::ldexp(fraction, -62 - 16)
                       : sign * std::ldexp(65536 + fraction, exponent - 63 - 16);
}

/// Copies samples of a row to native numbers, `step` bytes apart. `first` counts samples from the start of the row.
class RowReader {
 public:
  explicit RowReader(const TiffForm& form)
      : bits_(form.format >= SAMPLEFORMAT_COMPLEXINT ? form.bits / 2u : form.bits),
        size_(size_of(form.type)),
        is_signed_(form.format == SAMPLEFORMAT_INT || form.format == SAMPLEFORMAT_COMPLEXINT),
        is_float_(form.type == NumberType::f32 || form.type == NumberType::f64) {}

  void read(std::span<const std::byte> row, std::uint64_t first, std::uint64_t count, std::byte* to,
            std::size_t step) const {
    if (bits_ == size_ * 8) {
      if (step == size_) {
        std::memcpy(to, row.data() + first * size_, count * size_);
      } else {
        for (std::uint64_t i = 0; i < count; ++i) std::memcpy(to + i * step, row.data() + (first + i) * size_, size_);
      }
      return;
    }
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::uint64_t value = packed(row, (first + i) * bits_);
      if (is_float_) {
        const auto bits = static_cast<std::uint32_t>(value);
        const float number = bits_ == 16 ? half_to_float(bits) : float_of_24_bits(bits);
        std::memcpy(to + i * step, &number, sizeof(number));
      } else {
        std::memcpy(to + i * step, &value, size_);
      }
    }
  }

 private:
  // Returns bits of a row, the highest first, except that whole bytes are in native order.
  [[nodiscard]] std::uint64_t packed(std::span<const std::byte> row, std::uint64_t begin) const {
    std::uint64_t value = 0;
    if (bits_ % 8 == 0) {
      std::memcpy(&value, row.data() + begin / 8, bits_ / 8);
    } else {
      for (std::uint64_t bit = begin; bit < begin + bits_; ++bit)
        value = value << 1 | (std::to_integer<std::uint64_t>(row[bit / 8]) >> (7 - bit % 8) & 1);
    }
    if (is_signed_ && (value >> (bits_ - 1) & 1) != 0) value |= ~std::uint64_t{0} << bits_;
    return value;
  }
  static_assert(std::endian::native == std::endian::little);

  unsigned bits_;
  std::size_t size_;
  bool is_signed_, is_float_;
};

/// Copies a part of a decoded strip or tile to the box.
struct Block {
  std::span<const std::byte> bytes;
  std::uint32_t x = 0, y = 0, width = 0, height = 0;  // on the page
  std::uint64_t row_bytes = 0;
};

void copy_block(const TiffForm& form, const Block& block, std::uint16_t sample, const TiffBox& box,
                std::span<std::byte> to) {
  const std::uint32_t left = std::max(block.x, box.x), right = std::min(block.x + block.width, box.x + box.width);
  const std::uint32_t top = std::max(block.y, box.y), bottom = std::min(block.y + block.height, box.y + box.height);
  if (left >= right) return;
  const bool complex = form.format >= SAMPLEFORMAT_COMPLEXINT;
  const std::uint32_t numbers = complex ? 2 : 1;  // of a sample
  const std::size_t size = size_of(form.type), pixel = size * form.parts;
  const std::uint32_t samples = form.apart ? 1 : form.samples;
  const RowReader rows(form);
  for (std::uint32_t y = top; y < bottom; ++y) {
    const auto row = block.bytes.subspan((y - block.y) * block.row_bytes, block.row_bytes);
    std::byte* out = to.data() + (std::uint64_t{y - box.y} * box.width + (left - box.x)) * pixel;
    const std::uint64_t first = std::uint64_t{left - block.x} * samples * numbers;
    const std::uint64_t count = std::uint64_t{right - left} * samples * numbers;
    if (!form.apart) {
      rows.read(row, first, count, out, size);
    } else if (numbers == 1) {
      rows.read(row, first, count, out + sample * size, pixel);
    } else {
      for (std::uint64_t i = 0; i < right - left; ++i)
        rows.read(row, first + i * numbers, numbers, out + i * pixel + sample * numbers * size, size);
    }
  }
}

std::string read_blocks(TiffHandle& file, const TiffForm& form, const TiffBox& box, std::span<std::byte> to) {
  TIFF* const tiff = file.get();
  std::uint32_t width = form.width, height = form.height;
  if (form.tiled) {
    TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &width);
    TIFFGetField(tiff, TIFFTAG_TILELENGTH, &height);
  } else {
    TIFFGetFieldDefaulted(tiff, TIFFTAG_ROWSPERSTRIP, &height);
    height = std::min(height, form.height);
  }
  const std::uint64_t size = form.tiled ? TIFFTileSize64(tiff) : TIFFStripSize64(tiff);
  const std::uint64_t row_bytes = form.tiled ? TIFFTileRowSize64(tiff) : TIFFScanlineSize64(tiff);
  const unsigned bits = form.bits * (form.apart ? 1u : form.samples);
  if (width == 0 || height == 0 || size == 0 || size > kMostBlock)
    return "strips or tiles of " + std::to_string(size) + " bytes; expected at most " + std::to_string(kMostBlock);
  if (row_bytes < (std::uint64_t{width} * bits + 7) / 8 || row_bytes > size) return "rows of an unexpected size";
  std::vector<std::byte> block(size);
  const std::uint16_t planes = form.apart ? form.samples : std::uint16_t{1};
  const std::uint32_t first_x = box.x / width * width, first_y = box.y / height * height;
  const auto visit = [&](const auto& read) -> std::string {
    for (std::uint16_t plane = 0; plane < planes; ++plane)
      for (std::uint64_t y = first_y; y < std::uint64_t{box.y} + box.height; y += height)
        for (std::uint64_t x = first_x; x < std::uint64_t{box.x} + box.width; x += width) {
          std::string problem = read(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), plane);
          if (!problem.empty()) return problem;
        }
    return {};
  };
  const auto number = [&](std::uint32_t left, std::uint32_t top, std::uint16_t plane) {
    return form.tiled ? TIFFComputeTile(tiff, left, top, 0, plane) : TIFFComputeStrip(tiff, top, plane);
  };
  if (file.need()) {
    // Receives all blocks of the box at once.
    NeededParts needed(file.need());
    std::string problem = visit([&](std::uint32_t left, std::uint32_t top, std::uint16_t plane) {
      const std::uint32_t block_number = number(left, top, plane);
      const bool good =
          needed.add(TIFFGetStrileOffset(tiff, block_number), TIFFGetStrileByteCount(tiff, block_number));
      return std::string(good ? "" : "a strip or tile cannot be received");
    });
    if (problem.empty() && !needed.finish()) problem = "a strip or tile cannot be received";
    if (!problem.empty()) return problem;
  }
  return visit([&](std::uint32_t left, std::uint32_t top, std::uint16_t plane) -> std::string {
        const std::uint32_t rows = form.tiled ? height : std::min(height, form.height - top);
        const auto bytes = static_cast<tmsize_t>(form.tiled ? size : rows * row_bytes);
        file.forget_problem();
        const tmsize_t got = form.tiled ? TIFFReadEncodedTile(tiff, number(left, top, plane), block.data(), bytes)
                                        : TIFFReadEncodedStrip(tiff, number(left, top, plane), block.data(), bytes);
        if (got < bytes) return file.problem("a strip or tile cannot be read");
        copy_block(form, {block, left, top, width, rows, row_bytes}, plane, box, to);
        return {};
      });
}

/// Reads a page through the conversion of libtiff to red, green, blue and opacity.
std::string read_converted(TiffHandle& file, const TiffForm& form, const TiffBox& box, std::span<std::byte> to) {
  const std::uint64_t pixels = std::uint64_t{form.width} * form.height;
  if (pixels * 4 > kMostBlock) return "a page of this kind of colours is too large";
  std::vector<std::uint32_t> raster(pixels);
  file.forget_problem();
  if (!TIFFReadRGBAImageOriented(file.get(), form.width, form.height, raster.data(), ORIENTATION_TOPLEFT, 1))
    return file.problem("a page cannot be converted to colours");
  for (std::uint32_t y = 0; y < box.height; ++y)
    for (std::uint32_t x = 0; x < box.width; ++x) {
      const std::uint32_t color = raster[std::uint64_t{box.y + y} * form.width + box.x + x];
      std::byte* out = to.data() + (std::uint64_t{y} * box.width + x) * 3;
      for (unsigned i = 0; i < 3; ++i) out[i] = static_cast<std::byte>(color >> 8 * i & 0xff);
    }
  return {};
}

/// Reads a page with a colour table.
std::string read_palette(TiffHandle& file, const TiffForm& form, const TiffBox& box, std::span<std::byte> to) {
  std::uint16_t* tables[3] = {};
  if (!TIFFGetField(file.get(), TIFFTAG_COLORMAP, &tables[0], &tables[1], &tables[2])) return "no colour table";
  TiffForm indices = form;
  indices.mode = TiffMode::stored;
  indices.parts = 1;
  indices.type = number_type(form.bits, SAMPLEFORMAT_UINT);
  const std::uint64_t count = std::uint64_t{box.width} * box.height;
  std::vector<std::byte> numbers(count * size_of(indices.type));
  if (std::string problem = read_blocks(file, indices, box, numbers); !problem.empty()) return problem;
  const std::size_t entries = std::size_t{1} << form.bits;
  for (std::uint64_t i = 0; i < count; ++i) {
    std::uint16_t index = 0;
    std::memcpy(&index, numbers.data() + i * size_of(indices.type), size_of(indices.type));
    for (std::size_t k = 0; k < 3; ++k) to[i * 3 + k] = static_cast<std::byte>(tables[k][index % entries] >> 8);
  }
  return {};
}

}  // namespace

TiffHandle::TiffHandle(ArrayBytes bytes) : bytes_(std::move(bytes)) {
  constexpr tmsize_t kMostMemory = tmsize_t{1} << 30;
  TIFFOpenOptions* const options = TIFFOpenOptionsAlloc();
  if (!options) return;
  TIFFOpenOptionsSetErrorHandlerExtR(options, report, this);
  TIFFOpenOptionsSetWarningHandlerExtR(options, ignore, this);
  TIFFOpenOptionsSetMaxSingleMemAlloc(options, kMostMemory);
  // "O": the offsets of strips are read when they are needed.
  tiff_ = TIFFClientOpenExt("TIFF", "rO", this, read, write, seek, close, size, map, unmap, options);
  TIFFOpenOptionsFree(options);
}

TiffHandle::~TiffHandle() {
  if (tiff_) TIFFClose(tiff_);
}

std::string TiffHandle::problem(const char* otherwise) const { return problem_.empty() ? otherwise : problem_; }

tmsize_t TiffHandle::read(thandle_t handle, void* to, tmsize_t size) {
  auto& file = *static_cast<TiffHandle*>(handle);
  const std::uint64_t all = file.bytes_.bytes.size();
  const std::uint64_t there = file.at_ < all ? all - file.at_ : 0;
  const std::uint64_t count = std::min<std::uint64_t>(there, size > 0 ? static_cast<std::uint64_t>(size) : 0);
  if (!have_bytes(file.bytes_.need, file.at_, count)) return -1;
  if (count > 0) std::memcpy(to, file.bytes_.bytes.data() + file.at_, count);
  file.at_ += count;
  return static_cast<tmsize_t>(count);
}

tmsize_t TiffHandle::write(thandle_t, void*, tmsize_t) { return 0; }

toff_t TiffHandle::seek(thandle_t handle, toff_t offset, int whence) {
  auto& file = *static_cast<TiffHandle*>(handle);
  if (whence == SEEK_CUR) offset += file.at_;
  if (whence == SEEK_END) offset += file.bytes_.bytes.size();
  return file.at_ = offset;
}

int TiffHandle::close(thandle_t) { return 0; }

toff_t TiffHandle::size(thandle_t handle) { return static_cast<TiffHandle*>(handle)->bytes_.bytes.size(); }

int TiffHandle::map(thandle_t handle, void** base, toff_t* size) {
  if (static_cast<TiffHandle*>(handle)->bytes_.need) return 0;
  const auto bytes = static_cast<TiffHandle*>(handle)->bytes_.bytes;
  *base = const_cast<std::byte*>(bytes.data());
  *size = bytes.size();
  return 1;
}

void TiffHandle::unmap(thandle_t, void*, toff_t) {}

int TiffHandle::report(TIFF*, void* user, const char*, const char* format, va_list arguments) {
  std::array<char, 256> text{};
  std::vsnprintf(text.data(), text.size(), format, arguments);
  std::string& problem = static_cast<TiffHandle*>(user)->problem_;
  problem = text.data();
  for (char& c : problem)
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e) c = ' ';
  return 1;
}

int TiffHandle::ignore(TIFF*, void*, const char*, const char*, va_list) { return 1; }

TiffForm tiff_form_of(TIFF* tiff, bool keep_palette) {
  TiffForm form;
  TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &form.width);
  TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &form.height);
  form.samples = short_field(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  form.bits = short_field(tiff, TIFFTAG_BITSPERSAMPLE, 1);
  form.format = short_field(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
  if (form.format == SAMPLEFORMAT_VOID) form.format = SAMPLEFORMAT_UINT;
  form.apart =
      form.samples > 1 && short_field(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) == PLANARCONFIG_SEPARATE;
  form.tiled = TIFFIsTiled(tiff) != 0;
  constexpr std::uint32_t kMostSide = 1u << 30;
  constexpr std::uint16_t kMostSamples = 4096;
  if (form.width == 0 || form.height == 0 || form.width > kMostSide || form.height > kMostSide || form.samples == 0 ||
      form.samples > kMostSamples)
    return form;
  std::uint16_t photometric = PHOTOMETRIC_MINISBLACK, compression = COMPRESSION_NONE;
  TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &photometric);
  TIFFGetField(tiff, TIFFTAG_COMPRESSION, &compression);
  if (compression == COMPRESSION_JPEG && photometric == PHOTOMETRIC_YCBCR) {
    TIFFSetField(tiff, TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
    photometric = PHOTOMETRIC_RGB;
  }
  const bool byte_like = form.bits <= 16 && form.format == SAMPLEFORMAT_UINT;
  if (photometric == PHOTOMETRIC_YCBCR || photometric == PHOTOMETRIC_SEPARATED || photometric == PHOTOMETRIC_CIELAB ||
      photometric == PHOTOMETRIC_LOGL || photometric == PHOTOMETRIC_LOGLUV) {
    form.mode = TiffMode::rgba;
    form.colors = true;
    form.type = NumberType::u8;
    form.parts = 3;
  } else if (photometric == PHOTOMETRIC_PALETTE && form.samples == 1 && byte_like && form.bits <= 8 && !keep_palette) {
    form.mode = TiffMode::palette;
    form.colors = true;
    form.type = NumberType::u8;
    form.parts = 3;
  } else {
    form.type = number_type(form.bits, form.format);
    form.parts = form.samples * (form.format >= SAMPLEFORMAT_COMPLEXINT ? 2u : 1u);
    form.colors = photometric == PHOTOMETRIC_RGB && form.parts >= 3 && byte_like;
    form.inverted = photometric == PHOTOMETRIC_MINISWHITE && form.bits == 1 && form.samples == 1;
  }
  return form;
}

std::string read_tiff_page(TiffHandle& file, const TiffForm& form, const TiffBox& box, std::span<std::byte> to) {
  switch (form.mode) {
    case TiffMode::rgba:
      return read_converted(file, form, box, to);
    case TiffMode::palette:
      return read_palette(file, form, box, to);
    case TiffMode::stored:
      break;
  }
  std::string problem = read_blocks(file, form, box, to);
  if (form.inverted)
    for (std::byte& sample : to) sample ^= std::byte{1};
  return problem;
}

}  // namespace gs::app
