#include "app/formats/datasets/module/picture_decoders.h"

#include <gdcmByteValue.h>
#include <gdcmDataElement.h>
#include <gdcmFragment.h>
#include <gdcmJPEG2000Codec.h>
#include <gdcmJPEGCodec.h>
#include <gdcmJPEGLSCodec.h>
#include <gdcmSequenceOfFragments.h>
#include <gdcmTrace.h>

#include <array>
#include <csetjmp>
#include <cstdio>
#include <exception>
#include <mutex>
#include <optional>

#include <jpeglib.h>

namespace gs::app {
namespace {

/// Size of a picture as its own header states it.
struct CodedSize {
  std::uint32_t rows = 0, columns = 0, samples = 0, bits = 0;
  bool lossy = false;  // JPEG with discrete cosines
};

std::uint32_t big_endian_number(std::span<const std::byte> bytes, std::size_t at, std::size_t size) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value = value << 8 | std::to_integer<std::uint32_t>(bytes[at + i]);
  return value;
}

/// Reads the frame header of JPEG and JPEG-LS: SOF0 to SOF15, or SOF55.
std::optional<CodedSize> jpeg_size(std::span<const std::byte> bytes) {
  if (bytes.size() < 4 || big_endian_number(bytes, 0, 2) != 0xffd8) return std::nullopt;
  for (std::size_t at = 2; at + 4 <= bytes.size();) {
    if (bytes[at] != std::byte{0xff}) return std::nullopt;
    const std::uint32_t mark = big_endian_number(bytes, at + 1, 1);
    if (mark == 0xff) {
      ++at;
      continue;
    }
    const std::uint32_t length = big_endian_number(bytes, at + 2, 2);
    const bool is_frame =
        (mark >= 0xc0 && mark <= 0xcf && mark != 0xc4 && mark != 0xc8 && mark != 0xcc) || mark == 0xf7;
    if (is_frame && at + 10 <= bytes.size())
      return CodedSize{big_endian_number(bytes, at + 5, 2), big_endian_number(bytes, at + 7, 2),
                       big_endian_number(bytes, at + 9, 1), big_endian_number(bytes, at + 4, 1), mark <= 0xc2};
    if (length < 2) return std::nullopt;
    at += 2 + length;
  }
  return std::nullopt;
}

/// Reads the marker SIZ of a JPEG 2000 codestream, which may lie in a JP2 file.
std::optional<CodedSize> jpeg_2000_size(std::span<const std::byte> bytes) {
  constexpr std::size_t kSearched = 4096, kBytes = 41;
  for (std::size_t at = 0; at + kBytes <= bytes.size() && at < kSearched; ++at) {
    if (big_endian_number(bytes, at, 4) != 0xff4fff51) continue;
    const auto number = [&](std::size_t offset, std::size_t size) {
      return big_endian_number(bytes, at + offset, size);
    };
    const std::uint32_t width = number(8, 4), height = number(12, 4), left = number(16, 4), top = number(20, 4);
    if (left >= width || top >= height) return std::nullopt;
    return CodedSize{height - top, width - left, number(40, 2), (number(42, 1) & 0x7f) + 1};
  }
  return std::nullopt;
}

std::string size_text(std::uint32_t columns, std::uint32_t rows, std::uint32_t samples) {
  return std::to_string(columns) + " x " + std::to_string(rows) + " pixels of " + std::to_string(samples) +
         (samples == 1 ? " sample" : " samples");
}

/// Silences GDCM, and serialises its decoders, because their libraries have shared state.
class GdcmScope {
 public:
  GdcmScope() : lock_(mutex()) {
    static const bool silenced = [] {
      gdcm::Trace::DebugOff();
      gdcm::Trace::WarningOff();
      gdcm::Trace::ErrorOff();
      return true;
    }();
    (void)silenced;
  }

 private:
  static std::mutex& mutex() {
    static std::mutex all;
    return all;
  }
  std::lock_guard<std::mutex> lock_;
};

/// Returns a message if the header in the stream differs from that of the file. Decoders trust the former.
std::string check_size(const PictureForm& form, const std::optional<CodedSize>& size) {
  if (!size) return "no header of a picture";
  // GDCM trusts the sizes in the stream, so compare them with those of the file.
  if (size->rows != form.rows || size->columns != form.columns || size->samples != form.samples)
    return size_text(size->columns, size->rows, size->samples) + "; expected " +
           size_text(form.columns, form.rows, form.samples);
  if (size->bits == 0 || size->bits > form.bits_allocated)
    return std::to_string(size->bits) + " bits per sample; expected at most " + std::to_string(form.bits_allocated);
  return {};
}

/// State of libjpeg for a picture, with its own handling of errors.
struct LossyJpeg {
  jpeg_decompress_struct decoder{};
  jpeg_error_mgr errors{};
  std::jmp_buf failed{};
};

/// Decodes JPEG with 8 bits by libjpeg-turbo, without a conversion of colours. `row` has the size of a row. Returns
/// false on failure. Creates no objects, because a longjmp() leaves it.
bool decode_lossy(LossyJpeg& jpeg, std::span<const std::byte> bytes, std::byte* to, std::size_t row_bytes,
                  std::uint32_t rows) {
  jpeg.decoder.err = jpeg_std_error(&jpeg.errors);
  jpeg.decoder.client_data = &jpeg;
  jpeg.errors.error_exit = [](j_common_ptr decoder) {
    std::longjmp(static_cast<LossyJpeg*>(decoder->client_data)->failed, 1);
  };
  jpeg.errors.emit_message = [](j_common_ptr, int) {};
  jpeg.errors.output_message = [](j_common_ptr) {};
  if (setjmp(jpeg.failed) != 0) {
    jpeg_destroy_decompress(&jpeg.decoder);
    return false;
  }
  jpeg_create_decompress(&jpeg.decoder);
  jpeg_mem_src(&jpeg.decoder, reinterpret_cast<const unsigned char*>(bytes.data()),
               static_cast<unsigned long>(bytes.size()));
  jpeg_read_header(&jpeg.decoder, TRUE);
  jpeg.decoder.out_color_space = jpeg.decoder.jpeg_color_space;
  jpeg_start_decompress(&jpeg.decoder);
  const bool fits =
      jpeg.decoder.output_height == rows &&
      std::size_t{jpeg.decoder.output_width} * static_cast<std::size_t>(jpeg.decoder.output_components) == row_bytes;
  while (fits && jpeg.decoder.output_scanline < rows) {
    JSAMPROW row = reinterpret_cast<JSAMPROW>(to + jpeg.decoder.output_scanline * row_bytes);
    jpeg_read_scanlines(&jpeg.decoder, &row, 1);
  }
  jpeg_destroy_decompress(&jpeg.decoder);
  return fits;
}

template <class Codec>
std::string decode_with(std::span<const std::byte> bytes, const PictureForm& form, std::optional<CodedSize> size,
                        std::vector<std::byte>& to) {
  if (std::string problem = check_size(form, size); !problem.empty()) return problem;
  try {
    const GdcmScope scope;
    gdcm::Fragment fragment;
    fragment.SetByteValue(reinterpret_cast<const char*>(bytes.data()),
                          gdcm::VL(static_cast<std::uint32_t>(bytes.size())));
    const gdcm::SmartPointer<gdcm::SequenceOfFragments> fragments = new gdcm::SequenceOfFragments;
    fragments->AddFragment(fragment);
    gdcm::DataElement encoded(gdcm::Tag(0x7fe0, 0x0010)), decoded(gdcm::Tag(0x7fe0, 0x0010));
    encoded.SetVR(gdcm::VR::OB);
    encoded.SetValue(*fragments);
    Codec codec;
    const std::array<unsigned, 3> dimensions{form.columns, form.rows, 1};
    codec.SetNumberOfDimensions(2);
    codec.SetDimensions(dimensions.data());
    codec.SetPlanarConfiguration(0);
    codec.SetPhotometricInterpretation(form.samples == 3 ? gdcm::PhotometricInterpretation::RGB
                                                         : gdcm::PhotometricInterpretation::MONOCHROME2);
    codec.SetPixelFormat(gdcm::PixelFormat(static_cast<unsigned short>(form.samples),
                                           static_cast<unsigned short>(form.bits_allocated),
                                           static_cast<unsigned short>(form.bits_stored),
                                           static_cast<unsigned short>(form.bits_stored - 1), form.is_signed ? 1 : 0));
    if constexpr (requires { codec.SetLossless(true); }) codec.SetLossless(form.lossless);
    if constexpr (requires { codec.SetBufferLength(0); })
      codec.SetBufferLength(std::size_t{form.rows} * form.columns * form.samples * ((form.bits_allocated + 7) / 8));
    if (!codec.Decode(encoded, decoded)) return "damaged data";
    const gdcm::ByteValue* value = decoded.GetByteValue();
    if (!value || !value->GetPointer()) return "damaged data";
    const auto* first = reinterpret_cast<const std::byte*>(value->GetPointer());
    to.assign(first, first + value->GetLength());
    return {};
  } catch (const std::exception&) {
    return "damaged data";
  }
}

}  // namespace

std::string decode_jpeg(std::span<const std::byte> bytes, const PictureForm& form, std::vector<std::byte>& to) {
  const auto size = jpeg_size(bytes);
  if (!size || !size->lossy || size->bits != 8) return decode_with<gdcm::JPEGCodec>(bytes, form, size, to);
  if (std::string problem = check_size(form, size); !problem.empty()) return problem;
  const std::size_t row_bytes = std::size_t{form.columns} * form.samples;
  to.resize(row_bytes * form.rows);
  LossyJpeg jpeg;
  return decode_lossy(jpeg, bytes, to.data(), row_bytes, form.rows) ? "" : "damaged data";
}

std::string decode_jpeg_ls(std::span<const std::byte> bytes, const PictureForm& form, std::vector<std::byte>& to) {
  return decode_with<gdcm::JPEGLSCodec>(bytes, form, jpeg_size(bytes), to);
}

std::string decode_jpeg_2000(std::span<const std::byte> bytes, const PictureForm& form, std::vector<std::byte>& to) {
  return decode_with<gdcm::JPEG2000Codec>(bytes, form, jpeg_2000_size(bytes), to);
}

}  // namespace gs::app
