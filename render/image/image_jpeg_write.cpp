#include "base/noncopyable.h"
#include "render/image/image.h"

#include <array>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>

#include <jpeglib.h>

// Encoder of JPEG (ISO/IEC 10918-1) with scans that refine the whole image.
namespace gs::render {
namespace {

/// Returns a scan of one component with coefficients `first` to `last`, without their lowest `low` bits. If the scan
/// refines an earlier scan, `before` is the `low` of that scan. Otherwise `before` is 0.
constexpr jpeg_scan_info scan_of(int component, int first, int last, int before, int low) {
  return {1, {component, 0, 0, 0}, first, last, before, low};
}
// Order of the scans: low frequencies and high bits first. Each prefix is then about as good as a separate file of its
// size.
constexpr jpeg_scan_info means_of_colors(int before, int low) { return {3, {0, 1, 2, 0}, 0, 0, before, low}; }
constexpr jpeg_scan_info means_of_greys(int before, int low) { return {1, {0, 0, 0, 0}, 0, 0, before, low}; }
constexpr std::array<jpeg_scan_info, 21> kColorScans{{
    means_of_colors(0, 3),    scan_of(0, 1, 8, 0, 4),  scan_of(1, 1, 8, 0, 3),  scan_of(2, 1, 8, 0, 3),
    scan_of(0, 9, 63, 0, 4),  means_of_colors(3, 2),   scan_of(0, 1, 63, 4, 3), scan_of(1, 9, 63, 0, 3),
    scan_of(2, 9, 63, 0, 3),  scan_of(0, 1, 63, 3, 2), means_of_colors(2, 1),   scan_of(1, 1, 63, 3, 2),
    scan_of(2, 1, 63, 3, 2),  scan_of(0, 1, 63, 2, 1), means_of_colors(1, 0),   scan_of(1, 1, 63, 2, 1),
    scan_of(2, 1, 63, 2, 1),  scan_of(0, 1, 20, 1, 0), scan_of(1, 1, 63, 1, 0), scan_of(2, 1, 63, 1, 0),
    scan_of(0, 21, 63, 1, 0),
}};
constexpr std::array<jpeg_scan_info, 10> kGreyScans{{
    means_of_greys(0, 3),
    scan_of(0, 1, 8, 0, 4),
    scan_of(0, 9, 63, 0, 4),
    means_of_greys(3, 2),
    scan_of(0, 1, 63, 4, 3),
    scan_of(0, 1, 63, 3, 2),
    means_of_greys(2, 1),
    scan_of(0, 1, 63, 2, 1),
    means_of_greys(1, 0),
    scan_of(0, 1, 63, 1, 0),
}};

/// State of the encoder. libjpeg leaves functions by longjmp, so this object owns all resources.
struct JpegWriter : NonCopyable {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  std::jmp_buf escape{};
  unsigned char* memory = nullptr;
  unsigned long size = 0;
  bool created = false;

  ~JpegWriter() {
    if (created) jpeg_destroy_compress(&jpeg);
    std::free(memory);
  }
};

bool write(JpegWriter& writer, const Image& image, const JpegOptions& options) {
  jpeg_compress_struct& jpeg = writer.jpeg;
  jpeg.err = jpeg_std_error(&writer.errors);
  jpeg.client_data = &writer;
  writer.errors.error_exit = [](j_common_ptr common) {
    std::longjmp(static_cast<JpegWriter*>(common->client_data)->escape, 1);
  };
  writer.errors.output_message = [](j_common_ptr) {};
  if (setjmp(writer.escape)) return false;
  jpeg_create_compress(&jpeg);
  writer.created = true;
  jpeg.client_data = &writer;
  jpeg_mem_dest(&jpeg, &writer.memory, &writer.size);
  jpeg.image_width = image.width;
  jpeg.image_height = image.height;
  jpeg.input_components = static_cast<int>(image.components);
  jpeg.in_color_space = image.components == 1 ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, options.quality, TRUE);
  jpeg.optimize_coding = TRUE;
  jpeg.dct_method = JDCT_ISLOW;
  if (options.full_chroma && image.components == 3)
    for (int c = 0; c < 3; ++c) jpeg.comp_info[c].h_samp_factor = jpeg.comp_info[c].v_samp_factor = 1;
  jpeg.scan_info = image.components == 1 ? kGreyScans.data() : kColorScans.data();
  jpeg.num_scans = static_cast<int>(image.components == 1 ? kGreyScans.size() : kColorScans.size());
  jpeg_start_compress(&jpeg, TRUE);
  const std::size_t stride = std::size_t{image.width} * image.components;
  while (jpeg.next_scanline < jpeg.image_height) {
    // libjpeg does not change the row.
    auto* row = const_cast<JSAMPROW>(image.pixels.data() + jpeg.next_scanline * stride);
    (void)jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  return true;
}

}  // namespace

std::vector<std::byte> encode_jpeg(const Image& image, const JpegOptions& options) {
  JpegWriter writer;
  const bool fits = (image.components == 1 || image.components == 3) && image.width > 0 && image.height > 0 &&
                    image.width <= JPEG_MAX_DIMENSION && image.height <= JPEG_MAX_DIMENSION &&
                    image.pixels.size() == std::size_t{image.width} * image.height * image.components;
  if (!fits || !write(writer, image, options)) return {};
  const auto* bytes = reinterpret_cast<const std::byte*>(writer.memory);
  return {bytes, bytes + writer.size};
}

std::vector<std::size_t> scan_ends(std::span<const std::byte> jpeg) {
  constexpr unsigned kStartOfScan = 0xDA, kRestart = 0xD0, kLastRestart = 0xD7, kEndOfImage = 0xD9;
  std::vector<std::size_t> ends;
  bool in_scan = false;
  for (std::size_t at = 2; at + 2 <= jpeg.size();) {
    const auto byte = [&](std::size_t i) {
      return at + i < jpeg.size() ? std::to_integer<unsigned>(jpeg[at + i]) : 0u;
    };
    // Inside a scan, 0 or a restart marker follows 0xFF; other markers end the scan.
    if (byte(0) != 0xFF || byte(1) == 0 || byte(1) == 0xFF || (byte(1) >= kRestart && byte(1) <= kLastRestart)) {
      ++at;
      continue;
    }
    if (in_scan) ends.push_back(at);
    in_scan = byte(1) == kStartOfScan;
    if (byte(1) == kEndOfImage) break;
    at += 2 + (byte(2) << 8 | byte(3));
  }
  return ends;
}

}  // namespace gs::render
