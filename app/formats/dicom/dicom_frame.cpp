#include "app/formats/dicom/dicom_frame.h"

#include "app/formats/datasets/arrays/dataset_module.h"
#include "base/text.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>

namespace gs::app {
namespace {

using DicomBytes = std::span<const std::byte>;

/// Returns the numbers of a table of offsets in the first fragment or in an element of its own.
std::vector<std::uint64_t> offsets_of(const DicomFile& file, std::uint32_t frames) {
  std::vector<std::uint64_t> offsets;
  const DicomBytes basic = file.fragments.front();
  if (basic.size() == std::size_t{frames} * 4) {
    for (std::size_t i = 0; i < frames; ++i) {
      std::uint32_t offset = 0;
      std::memcpy(&offset, basic.data() + i * 4, sizeof(offset));
      offsets.push_back(offset);
    }
    return offsets;
  }
  const DicomElement* extended = file.data.find(DicomTag::extended_offsets);
  if (!extended || extended->value.size() < std::size_t{frames} * 8) return offsets;
  for (std::size_t i = 0; i < frames; ++i) {
    std::uint64_t offset = 0;
    std::memcpy(&offset, extended->value.data() + i * 8, sizeof(offset));
    offsets.push_back(offset);
  }
  return offsets;
}

/// Reports whether a fragment begins an image: SOI of JPEG or SOC of JPEG 2000.
bool begins_image(DicomBytes fragment) {
  constexpr std::byte kMark{0xff};
  return fragment.size() >= 2 && fragment[0] == kMark &&
         (fragment[1] == std::byte{0xd8} || fragment[1] == std::byte{0x4f});
}

/// Returns the fragments of a frame.
std::span<const DicomBytes> fragments_of(const DicomFile& file, std::uint32_t frames, std::uint32_t frame) {
  const std::span<const DicomBytes> all = std::span(file.fragments).subspan(1);
  if (frames == 1) return all;
  if (all.size() == frames) return all.subspan(frame, 1);
  std::vector<std::size_t> begins;
  const std::vector<std::uint64_t> offsets = offsets_of(file, frames);
  std::uint64_t place = 0;
  constexpr std::uint64_t kItemHeader = 8;
  for (std::size_t i = 0; i < all.size() && begins.size() < frames; ++i) {
    const bool begin = offsets.empty() ? begins_image(all[i]) : place == offsets[begins.size()];
    if (begin) begins.push_back(i);
    place += kItemHeader + all[i].size();
  }
  if (frame >= begins.size()) return {};
  const std::size_t end = frame + 1 < begins.size() ? begins[frame + 1] : all.size();
  return all.subspan(begins[frame], end - begins[frame]);
}

/// Decodes a frame of RLE: a segment for each byte of a pixel, the highest byte of a sample first (PS3.5, annex G).
std::optional<std::string> decode_rle(DicomBytes bytes, const DicomPixels& pixels, std::span<std::byte> to) {
  constexpr std::size_t kHeader = 64;
  const std::uint64_t area = std::uint64_t{pixels.rows} * pixels.columns;
  const std::size_t width = pixels.sample_bytes(), segments = width * pixels.samples;
  const auto word = [&](std::size_t i) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + i * 4, sizeof(value));
    return value;
  };
  if (bytes.size() < kHeader || word(0) != segments)
    return "RLE with another number of segments; expected " + std::to_string(segments);
  for (std::size_t segment = 0; segment < segments; ++segment) {
    const std::size_t begin = word(segment + 1);
    const std::size_t end =
        segment + 1 < segments ? std::min<std::size_t>(word(segment + 2), bytes.size()) : bytes.size();
    const std::size_t sample = segment / width, byte = width - 1 - segment % width;
    std::byte* out = to.data() + sample * width + byte;
    const std::size_t step = width * pixels.samples;
    std::uint64_t made = 0;
    std::size_t at = begin;
    while (made < area && at + 1 < end) {
      const int code = std::to_integer<std::int8_t>(bytes[at++]);
      if (code >= 0) {
        for (int i = 0; i <= code && made < area && at < end; ++i, ++made) out[made * step] = bytes[at++];
      } else if (code != -128) {
        for (int i = 0; i <= -code && made < area; ++i, ++made) out[made * step] = bytes[at];
        ++at;
      }
    }
    if (made < area) return std::string("the RLE data of a frame end early");
  }
  return std::nullopt;
}

/// Copies a frame of native pixels. The samples of a pixel are brought together, and bytes are put into native order.
std::optional<std::string> decode_native(DicomBytes all, bool big_endian, const DicomPixels& pixels,
                                         std::uint64_t frame, std::span<std::byte> to) {
  const std::uint64_t samples = pixels.frame_samples(), bits = pixels.bits_allocated;
  const bool halved = pixels.color == DicomColor::ybr_full_422 && pixels.samples == 3;
  const std::uint64_t stored = halved ? samples / 3 * 2 : samples;
  const std::uint64_t first = frame * stored * bits;
  if ((first + stored * bits + 7) / 8 > all.size()) return std::string("the pixels of a frame are missing");
  const std::size_t width = pixels.sample_bytes();
  if (bits == 1) {
    for (std::uint64_t i = 0; i < samples; ++i)
      to[i] = all[(first + i) / 8] >> static_cast<int>((first + i) % 8) & std::byte{1};
    return std::nullopt;
  }
  if (bits == 12) {  // two samples in three bytes
    for (std::uint64_t i = 0; i < samples; ++i) {
      const std::uint64_t place = (first + i * 12) / 8;
      const auto low = std::to_integer<std::uint16_t>(all[place]);
      const auto high = place + 1 < all.size() ? std::to_integer<std::uint16_t>(all[place + 1]) : std::uint16_t{0};
      const auto value =
          static_cast<std::uint16_t>(((first + i * 12) % 8 == 0 ? low | high << 8 : low >> 4 | high << 4) & 0xfff);
      std::memcpy(to.data() + i * 2, &value, sizeof(value));
    }
    return std::nullopt;
  }
  const DicomBytes bytes = all.subspan(first / 8, stored * width);
  if (halved) {  // two brightnesses, then the colour of both
    for (std::uint64_t pair = 0; pair < samples / 6; ++pair)
      for (std::uint64_t i = 0; i < 2; ++i) {
        to[pair * 6 + i * 3] = bytes[pair * 4 + i];
        to[pair * 6 + i * 3 + 1] = bytes[pair * 4 + 2];
        to[pair * 6 + i * 3 + 2] = bytes[pair * 4 + 3];
      }
    return std::nullopt;
  }
  const bool apart = pixels.planar && pixels.samples > 1;
  const std::uint64_t area = samples / pixels.samples;
  if (!apart) {
    std::copy(bytes.begin(), bytes.end(), to.begin());
  } else {
    for (std::uint64_t i = 0; i < samples; ++i)
      std::memcpy(to.data() + (i % area * pixels.samples + i / area) * width, bytes.data() + i * width, width);
  }
  if (!big_endian || width == 1) return std::nullopt;
  for (std::uint64_t i = 0; i < samples; ++i) std::reverse(&to[i * width], &to[i * width] + width);
  return std::nullopt;
}

/// Removes bits that are not stored, and repeats the sign.
template <class T>
void keep_stored_bits(const DicomPixels& pixels, std::span<std::byte> samples) {
  const unsigned shift = pixels.high_bit + 1 - pixels.bits_stored, bits = pixels.bits_stored;
  constexpr unsigned kWidth = sizeof(T) * 8;
  if (bits >= kWidth) return;
  const T mask = static_cast<T>((T{1} << bits) - 1), sign = static_cast<T>(T{1} << (bits - 1));
  for (std::size_t i = 0; i < samples.size() / sizeof(T); ++i) {
    T value;
    std::memcpy(&value, samples.data() + i * sizeof(T), sizeof(T));
    value = static_cast<T>(static_cast<T>(value >> shift) & mask);
    if (pixels.is_signed && (value & sign) != 0) value = static_cast<T>(value | static_cast<T>(~mask));
    std::memcpy(samples.data() + i * sizeof(T), &value, sizeof(T));
  }
}

void keep_stored_bits(const DicomPixels& pixels, std::span<std::byte> samples) {
  switch (pixels.sample_bytes()) {
    case 1:
      return keep_stored_bits<std::uint8_t>(pixels, samples);
    case 2:
      return keep_stored_bits<std::uint16_t>(pixels, samples);
    case 4:
      return keep_stored_bits<std::uint32_t>(pixels, samples);
    default:
      return keep_stored_bits<std::uint64_t>(pixels, samples);
  }
}

/// Widens samples of `from` bytes to `to` bytes, in place. `samples` has the size of the result.
void widen_samples(std::span<std::byte> samples, std::size_t from, std::size_t to, bool is_signed) {
  for (std::size_t i = samples.size() / to; i-- > 0;) {
    std::array<std::byte, 8> value{};
    std::memcpy(value.data(), samples.data() + i * from, from);
    if (is_signed && (value[from - 1] & std::byte{0x80}) != std::byte{0})
      std::fill(value.begin() + static_cast<std::ptrdiff_t>(from), value.end(), std::byte{0xff});
    std::memcpy(samples.data() + i * to, value.data(), to);
  }
}

/// Converts brightness and two differences to red, green and blue (PS3.3, C.7.6.3.1.2).
void red_green_blue(std::span<std::byte> frame) {
  for (std::size_t i = 0; i + 3 <= frame.size(); i += 3) {
    const auto part = [&](std::size_t k) { return static_cast<double>(std::to_integer<int>(frame[i + k])); };
    const double y = part(0), blue = part(1) - 128, red = part(2) - 128;
    const auto byte = [](double value) { return static_cast<std::byte>(std::clamp(std::lround(value), 0L, 255L)); };
    frame[i] = byte(y + 1.402 * red);
    frame[i + 1] = byte(y - 0.344136 * blue - 0.714136 * red);
    frame[i + 2] = byte(y + 1.772 * blue);
  }
}

/// Reports whether a JPEG stream states by a marker that it has brightness and two differences: JFIF, or Adobe with the
/// transformation 1. Some files state RGB anyway.
bool states_ybr(DicomBytes bytes) {
  for (std::size_t at = 2; at + 4 <= bytes.size() && bytes[at] == std::byte{0xff};) {
    const auto mark = std::to_integer<unsigned>(bytes[at + 1]);
    const std::size_t length =
        std::to_integer<std::size_t>(bytes[at + 2]) << 8 | std::to_integer<std::size_t>(bytes[at + 3]);
    if (mark < 0xc0 || mark == 0xda || at + 2 + length > bytes.size()) return false;
    const std::string_view text = text_of(bytes.subspan(at + 4, std::max<std::size_t>(length, 2) - 2));
    if (mark == 0xe0 && text.starts_with("JFIF")) return true;
    if (mark == 0xee && text.starts_with("Adobe") && text.size() >= 12) return text[11] == 1;
    at += 2 + length;
  }
  return false;
}

std::optional<std::string> decode_with_module(const DicomFile& file, const DicomPixels& pixels, DicomBytes bytes,
                                              std::vector<std::byte>& to) {
  static constexpr std::array<std::string_view, 7> kDecoders{"", "", "JPEG", "JPEG", "JPEG-LS", "JPEG 2000", ""};
  const auto module = dataset_module();
  if (const auto* problem = std::get_if<std::string>(&module)) return *problem;
  const PictureForm form{pixels.rows,
                         pixels.columns,
                         pixels.samples,
                         pixels.bits_allocated,
                         pixels.bits_stored,
                         pixels.is_signed,
                         file.codec == DicomCodec::jpeg_lossless};
  const std::string_view name = kDecoders[static_cast<std::size_t>(file.codec)];
  for (const PictureDecoder& decoder : std::get<const DatasetModule*>(module)->pictures) {
    if (decoder.name != name) continue;
    std::vector<std::byte> decoded;
    if (std::string problem = decoder.decode(bytes, form, decoded); !problem.empty())
      return std::string(name) + ": " + problem;
    const std::size_t width = pixels.sample_bytes(), samples = to.size() / width;
    const std::size_t own = decoded.size() / samples;  // bytes of a decoded sample
    if (own * samples != decoded.size() || !(own == 1 || own == 2 || own == 4) || own > width)
      return std::string(name) + ": an image of another size than the frame";
    std::copy(decoded.begin(), decoded.end(), to.begin());
    if (file.codec == DicomCodec::jpeg && pixels.color == DicomColor::rgb && width == 1 && states_ybr(bytes))
      red_green_blue(to);
    if (own < width) widen_samples(to, own, width, pixels.is_signed && pixels.bits_stored <= own * 8);
    return std::nullopt;
  }
  return "the module for scientific formats has no decoder of " + std::string(name);
}

}  // namespace

std::optional<std::string> decode_dicom_frame(const DicomFile& file, const DicomPixels& pixels, std::uint32_t frame,
                                              std::vector<std::byte>& to) {
  to.assign(pixels.frame_samples() * pixels.sample_bytes(), std::byte{0});
  std::optional<std::string> problem;
  if (file.fragments.empty()) {
    const DicomElement* element = nullptr;
    for (const DicomTag tag : {DicomTag::pixels, DicomTag::float_pixels, DicomTag::double_pixels})
      if (!element) element = file.data.find(tag);
    if (!element) return std::string("no pixels");
    problem = decode_native(element->value, element->big_endian, pixels, frame, to);
  } else {
    const std::span<const DicomBytes> parts = fragments_of(file, pixels.frames, frame);
    if (parts.empty()) return std::string("the pixels of a frame are missing");
    std::vector<std::byte> joined;
    DicomBytes bytes = parts.front();
    if (parts.size() > 1) {
      for (const DicomBytes part : parts) joined.insert(joined.end(), part.begin(), part.end());
      bytes = joined;
    }
    if (file.codec == DicomCodec::native)
      problem = decode_native(bytes, false, pixels, 0, to);
    else if (file.codec == DicomCodec::rle)
      problem = decode_rle(bytes, pixels, to);
    else
      problem = decode_with_module(file, pixels, bytes, to);
  }
  if (problem) return problem;
  if (pixels.form == DicomSamples::integers) keep_stored_bits(pixels, to);
  return std::nullopt;
}

void dicom_colors(const DicomImage& image, std::vector<std::byte>& frame) {
  const DicomPixels& pixels = image.pixels;
  const std::size_t area = std::size_t{pixels.rows} * pixels.columns, width = pixels.sample_bytes();
  const auto sample = [&](std::size_t i) {
    std::uint32_t value = 0;
    std::memcpy(&value, frame.data() + i * width, std::min<std::size_t>(width, 4));
    return value;
  };
  if (pixels.color == DicomColor::palette) {
    std::vector<std::byte> colored(area * 3);
    for (std::size_t i = 0; i < area; ++i) {
      std::int64_t value = sample(i);
      if (pixels.is_signed) value = width == 1 ? static_cast<std::int8_t>(value) : static_cast<std::int16_t>(value);
      for (std::size_t channel = 0; channel < 3; ++channel) {
        const DicomTable& table = image.palette[channel];
        const auto last = static_cast<std::int64_t>(table.entries.size()) - 1;
        colored[i * 3 + channel] = static_cast<std::byte>(
            table.entries[static_cast<std::size_t>(std::clamp<std::int64_t>(value - table.first, 0, last))]);
      }
    }
    frame = std::move(colored);
    return;
  }
  if (width > 1) {
    const unsigned shift = pixels.bits_stored > 8 ? pixels.bits_stored - 8 : 0;
    for (std::size_t i = 0; i < area * 3; ++i) frame[i] = static_cast<std::byte>(sample(i) >> shift);
    frame.resize(area * 3);
  }
  if (pixels.color == DicomColor::rgb) return;
  red_green_blue(frame);
}

}  // namespace gs::app
