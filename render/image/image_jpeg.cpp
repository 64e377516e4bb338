#include "base/noncopyable.h"
#include "render/image/image_codecs.h"

#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <limits>

#include <jerror.h>
#include <jpeglib.h>

namespace gs::render {
namespace {

constexpr int kMaxScans = 100;  // a hostile progressive file may have thousands of scans, each a pass over the image
constexpr int kMaxBrokenScans = 8;
constexpr std::uint32_t kAllRows = std::numeric_limits<std::uint32_t>::max();

/// State that the callbacks of libjpeg share. libjpeg leaves functions by longjmp. So this object or the caller owns
/// all resources, and functions with setjmp have only trivial local variables.
struct JpegReader : NonCopyable {
  jpeg_decompress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg_source_mgr source{};
  jpeg_progress_mgr progress{};
  std::jmp_buf escape{};
  char message[JMSG_LENGTH_MAX] = "unknown error";
  bool created = false;
  bool ran_out = false;  // the file ended too early
  int broken_scans = 0, last_broken_scan = 0;
  std::uint32_t whole_rows = kAllRows;  // output rows that have complete data
  std::uint32_t components = 0;  // components of the result
  std::uint32_t reduction = 1;  // reduction by libjpeg: 1, 2, 4 or 8
  RowReducer* reducer = nullptr;  // receives the rows if libjpeg cannot reduce the image enough
  const ImageLimits* limits = nullptr;
  std::uint8_t* line = nullptr;  // one row in libjpeg's format, if that differs from the result's
  std::uint8_t* pixels = nullptr;

  ~JpegReader() {
    if (created) jpeg_destroy_decompress(&jpeg);
  }
};

JpegReader& reader_of(j_common_ptr jpeg) { return *static_cast<JpegReader*>(jpeg->client_data); }

void on_error(j_common_ptr jpeg) {
  JpegReader& reader = reader_of(jpeg);
  jpeg->err->format_message(jpeg, reader.message);
  std::longjmp(reader.escape, 1);
}

[[noreturn]] void fail(JpegReader& reader, const char* text) {
  std::snprintf(reader.message, sizeof reader.message, "%s", text);
  std::longjmp(reader.escape, 1);
}

/// Receives warnings. libjpeg fills missing data with grey; this function records where the grey begins.
void on_message(j_common_ptr common, int level) {
  if (level >= 0) return;
  ++common->err->num_warnings;
  if (common->err->msg_code != JWRN_HIT_MARKER) return;
  JpegReader& reader = reader_of(common);
  const jpeg_decompress_struct& jpeg = reader.jpeg;
  if (reader.ran_out && reader.whole_rows == kAllRows && jpeg.input_scan_number <= 1)
    reader.whole_rows = jpeg.input_iMCU_row * static_cast<std::uint32_t>(jpeg.max_v_samp_factor * DCTSIZE);
  if (reader.last_broken_scan == jpeg.input_scan_number) return;
  reader.last_broken_scan = jpeg.input_scan_number;
  if (++reader.broken_scans > kMaxBrokenScans) fail(reader, "too many broken scans");
}

void on_progress(j_common_ptr common) {
  JpegReader& reader = reader_of(common);
  if (reader.jpeg.input_scan_number > kMaxScans) fail(reader, "too many scans");
}

void ignore(j_decompress_ptr) {}

/// Called if libjpeg needs more bytes. It has all bytes from the start, so the file is truncated.
boolean fill_with_end(j_decompress_ptr jpeg) {
  static const JOCTET kEnd[] = {0xFF, JPEG_EOI};
  jpeg->src->next_input_byte = kEnd;
  jpeg->src->bytes_in_buffer = sizeof kEnd;
  reader_of(reinterpret_cast<j_common_ptr>(jpeg)).ran_out = true;
  return TRUE;
}

void skip_bytes(j_decompress_ptr jpeg, long count) {
  if (count <= 0) return;
  if (static_cast<unsigned long>(count) >= jpeg->src->bytes_in_buffer) {
    (void)fill_with_end(jpeg);
    return;
  }
  jpeg->src->next_input_byte += count;
  jpeg->src->bytes_in_buffer -= static_cast<std::size_t>(count);
}

void connect(JpegReader& reader, std::span<const std::byte> bytes) {
  reader.jpeg.err = jpeg_std_error(&reader.errors);
  reader.errors.error_exit = on_error;
  reader.errors.emit_message = on_message;
  reader.errors.output_message = [](j_common_ptr) {};
  reader.jpeg.client_data = &reader;
  reader.source.init_source = ignore;
  reader.source.fill_input_buffer = fill_with_end;
  reader.source.skip_input_data = skip_bytes;
  reader.source.resync_to_restart = jpeg_resync_to_restart;
  reader.source.term_source = ignore;
  reader.source.next_input_byte = reinterpret_cast<const JOCTET*>(bytes.data());
  reader.source.bytes_in_buffer = bytes.size();
  reader.progress.progress_monitor = on_progress;
}

bool read_header(JpegReader& reader) {
  if (setjmp(reader.escape)) return false;
  // This clears the struct, except `err` and `client_data`.
  jpeg_create_decompress(&reader.jpeg);
  reader.created = true;
  reader.jpeg.src = &reader.source;
  reader.jpeg.progress = &reader.progress;
  jpeg_read_header(&reader.jpeg, TRUE);
  switch (reader.jpeg.jpeg_color_space) {
    case JCS_GRAYSCALE:
      reader.jpeg.out_color_space = JCS_GRAYSCALE;
      reader.components = 1;
      break;
    case JCS_CMYK:
    case JCS_YCCK:
      reader.jpeg.out_color_space = JCS_CMYK;
      reader.components = 3;
      break;
    case JCS_RGB:
    case JCS_YCbCr:
      reader.jpeg.out_color_space = JCS_RGB;
      reader.components = 3;
      break;
    default:
      fail(reader, "unknown colour space; expected grey, YCbCr, RGB, CMYK or YCCK");
  }
  return true;
}

bool start(JpegReader& reader) {
  if (setjmp(reader.escape)) return false;
  jpeg_start_decompress(&reader.jpeg);
  return true;
}

/// Converts CMYK to RGB. Adobe's files store inverted inks: 255 means no ink.
void rgb_of_cmyk(const std::uint8_t* cmyk, std::uint8_t* rgb, std::uint32_t width, bool inverted) {
  for (std::uint32_t x = 0; x < width; ++x, cmyk += 4, rgb += 3) {
    const unsigned black = inverted ? cmyk[3] : 255u - cmyk[3];
    for (int c = 0; c < 3; ++c) {
      const unsigned light = inverted ? cmyk[c] : 255u - cmyk[c];
      rgb[c] = static_cast<std::uint8_t>((light * black + 127) / 255);
    }
  }
}

/// Returns the number of output rows that have complete data.
std::uint32_t whole_rows(const JpegReader& reader) {
  return reader.whole_rows == kAllRows ? kAllRows : reader.whole_rows / reader.reduction;
}

bool read_rows(JpegReader& reader) {
  if (setjmp(reader.escape)) return false;
  const std::size_t stride = std::size_t{reader.jpeg.output_width} * reader.components;
  while (reader.jpeg.output_scanline < reader.jpeg.output_height) {
    if (reader.jpeg.output_scanline >= whole_rows(reader)) break;
    if (reader.limits->stopped && reader.limits->stopped()) break;
    std::uint8_t* row = reader.pixels + (reader.reducer ? 0 : reader.jpeg.output_scanline * stride);
    JSAMPROW target = reader.line ? reader.line : row;
    if (jpeg_read_scanlines(&reader.jpeg, &target, 1) != 1) break;
    if (reader.line) rgb_of_cmyk(reader.line, row, reader.jpeg.output_width, reader.jpeg.saw_Adobe_marker);
    if (reader.reducer) reader.reducer->take(row);
  }
  return true;
}

/// Returns an error if a progressive image needs too much memory: libjpeg holds all its coefficients. Returns nullopt
/// otherwise.
std::optional<ImageError> refuse_coefficients(JpegReader& reader, const ImageLimits& limits) {
  const std::uint64_t bytes = std::uint64_t{reader.jpeg.image_width} * reader.jpeg.image_height *
                              static_cast<std::uint64_t>(reader.jpeg.num_components) * sizeof(JCOEF);
  if (!jpeg_has_multiple_scans(&reader.jpeg) || bytes <= limits.working_bytes) return std::nullopt;
  return ImageError{"progressive JPEG image of " + std::to_string(reader.jpeg.image_width) + "x" +
                    std::to_string(reader.jpeg.image_height) + " pixels, which takes " + std::to_string(bytes) +
                    " bytes to decode; expected at most " + std::to_string(limits.working_bytes)};
}

ImageError jpeg_error_of(const JpegReader& reader) { return {std::string("broken JPEG: ") + reader.message}; }

/// Returns the offset of the last marker outside of scans. Returns 0 if no marker exists.
std::size_t last_marker(std::span<const std::byte> bytes) {
  for (std::size_t i = bytes.size() < 2 ? 0 : bytes.size() - 2; i > 0; --i) {
    const auto code = static_cast<unsigned>(bytes[i + 1]);
    const bool in_scan = code == 0 || code == 0xFF || (code >= JPEG_RST0 && code <= JPEG_RST0 + 7);
    if (bytes[i] == std::byte{0xFF} && !in_scan) return i;
  }
  return 0;
}

DecodedImage decode_once(std::span<const std::byte> bytes, const ImageLimits& limits, bool& cut_in_marker) {
  JpegReader reader;
  reader.limits = &limits;
  connect(reader, bytes);
  if (!read_header(reader)) return jpeg_error_of(reader);
  if (auto refused = refuse_size("JPEG", reader.jpeg.image_width, reader.jpeg.image_height, limits))
    return *std::move(refused);
  if (auto refused = refuse_coefficients(reader, limits)) return *std::move(refused);
  const std::uint32_t reduction = reduction_of(reader.jpeg.image_width, reader.jpeg.image_height, limits);
  while (reader.reduction < 8 && reader.reduction * 2 <= reduction) reader.reduction *= 2;
  reader.jpeg.scale_denom = reader.reduction;
  if (!start(reader)) {
    cut_in_marker = reader.ran_out;
    return jpeg_error_of(reader);
  }
  if (reader.whole_rows == 0) return ImageError{"broken JPEG: the data ends before the first rows of the picture"};

  const std::uint32_t width = reader.jpeg.output_width, height = reader.jpeg.output_height;
  const std::uint32_t rest = reduction_of(width, height, limits);
  Image image;
  RowReducer reducer(image, width, height, reader.components, rest);
  std::vector<std::uint8_t> line, row;
  if (reader.jpeg.out_color_space == JCS_CMYK) {
    line.resize(std::size_t{width} * 4);
    reader.line = line.data();
  }
  if (rest > 1) {
    row.resize(std::size_t{width} * reader.components);
    reader.reducer = &reducer;
  }
  reader.pixels = rest > 1 ? row.data() : image.pixels.data();
  const bool finished = read_rows(reader);
  reducer.finish();
  image.reduction = rest * reader.reduction;
  if (!finished && reader.jpeg.output_scanline == 0) return jpeg_error_of(reader);
  if (reader.whole_rows == 0) return ImageError{"broken JPEG: the data ends before the first rows of the picture"};
  if (whole_rows(reader) / rest < image.height) {
    // Keep only rows with complete data; libjpeg may have written grey rows after them.
    const std::size_t kept = std::size_t{image.width} * image.components * (whole_rows(reader) / rest);
    std::memset(image.pixels.data() + kept, 0, image.pixels.size() - kept);
  }
  return image;
}

}  // namespace

DecodedImage decode_jpeg(std::span<const std::byte> bytes, const ImageLimits& limits) {
  // libjpeg fails if a progressive file ends inside the tables of a later scan. Decode again without these tables: the
  // earlier scans are a coarse image. Bytes of tables can look like a marker, so try several times.
  constexpr int kTries = 4;
  for (int attempt = 1;; ++attempt) {
    bool cut_in_marker = false;
    DecodedImage result = decode_once(bytes, limits, cut_in_marker);
    const std::size_t end = cut_in_marker && attempt < kTries ? last_marker(bytes) : 0;
    if (end == 0) return result;
    bytes = bytes.first(end);
  }
}

}  // namespace gs::render
