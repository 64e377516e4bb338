#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

namespace gs::vrml {
struct Node;
}

namespace gs::render {

/// Pixels of 8 bits a component, rows from the top, tightly packed.
/// 1 intensity, 2 intensity + alpha, 3 RGB, 4 RGBA: the four kinds of texture of VRML97 4.6.11.
struct Image {
  std::uint32_t width = 0, height = 0, components = 0;
  std::vector<std::uint8_t> pixels;  // width * height * components
  std::uint32_t reduction = 1;       // pixels of the file, in each direction, that one of these stands for
  std::uint64_t version = 0;         // of an image that changes in its place: another number, other pixels

  [[nodiscard]] bool empty() const { return pixels.empty(); }
  [[nodiscard]] bool has_alpha() const { return components == 2 || components == 4; }
};

/// What an image is for: a node, and which of its NodeType::url_fields names it (ImageTexture has one, Background six).
struct ImagePlace {
  ImagePlace(const vrml::Node* of, std::size_t url_field = 0) : node(of), url(url_field) {}
  const vrml::Node* node;
  std::size_t url;
  friend bool operator==(const ImagePlace&, const ImagePlace&) = default;
};
struct HashImagePlace {
  std::size_t operator()(const ImagePlace& place) const {
    return std::hash<const vrml::Node*>()(place.node) + place.url;
  }
};
/// Images of the nodes of a world. Those that have not arrived or are broken are absent.
using Images = std::unordered_map<ImagePlace, std::shared_ptr<const Image>, HashImagePlace>;

/// What a decoder could not read, and what was expected.
struct ImageError {
  std::string message;
};

/// What decoding may cost.
struct ImageLimits {
  std::size_t file_pixels = std::size_t{1} << 28;    // larger pictures are refused: unpacking them takes too long
  std::size_t kept_pixels = std::size_t{1} << 28;    // larger ones are made smaller while they are unpacked
  std::size_t working_bytes = std::size_t{1} << 29;  // that a decoder may hold besides the result
  std::function<bool()> stopped = {};                // asked for every row: true ends it. Null: nobody does
};

/// Decodes PNG, JPEG, GIF and movies (first picture), BMP, binary PPM and PGM, and Targa, told apart by their first
/// bytes. JPEG grey is intensity; a PNG or GIF palette follows VRML97 4.6.11.2. Safe for untrusted input: memory is
/// bounded by `limits`. A truncated JPEG or PNG gives the rows that were there.
[[nodiscard]] std::variant<Image, ImageError> decode_image(std::span<const std::byte> bytes,
                                                           const ImageLimits& limits = {});

/// PNG bytes of an image of 1 to 4 components. `dots_per_inch`: how large it is printed; 0: nothing is said of that.
[[nodiscard]] std::vector<std::byte> encode_png(const Image& image, double dots_per_inch = 0);

struct JpegOptions {
  int quality = 90;          // 1 to 100
  bool full_chroma = false;  // colours as finely as brightness
};
/// Progressive JPEG bytes of an image of 1 or 3 components: its scans make it finer and finer. None where it is too
/// large.
[[nodiscard]] std::vector<std::byte> encode_jpeg(const Image& image, const JpegOptions& options = {});
/// Where the scans of a JPEG file end, each of which shows all of the picture where it is progressive. Safe for
/// untrusted bytes.
[[nodiscard]] std::vector<std::size_t> scan_ends(std::span<const std::byte> jpeg);

/// A PNG picture that comes in bands of rows, of which only the compressed bytes are kept.
class PngWriter {
 public:
  /// 1 to 4 components. Sizes that PNG or zlib cannot count make no picture: `finish` gives no bytes.
  PngWriter(std::uint32_t width, std::uint32_t height, std::uint32_t components, double dots_per_inch = 0);
  /// The next rows, from the top: an image as wide, of as many components.
  void add(const Image& band);
  /// The bytes; none where not as many rows as the picture has have come.
  [[nodiscard]] std::vector<std::byte> finish();

 private:
  std::uint32_t width_, height_, components_, rows_ = 0;
  bool good_;
  std::uint32_t checksum_ = 1;       // Adler-32 of all rows
  std::vector<std::uint8_t> above_;  // the last row of the band before
  std::vector<std::byte> bytes_;
};

/// How far two pictures of one size are apart, over all components; PSNR in dB (infinite when equal).
struct ImageDifference {
  double maximum = 0, mean = 0, psnr = 0;
  std::size_t differing_pixels = 0;
};
[[nodiscard]] std::variant<ImageDifference, ImageError> compare(const Image& a, const Image& b);

}  // namespace gs::render
