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

/// Image with 8 bits per component, rows from the top, tightly packed. The components are those of VRML97 4.6.11: 1
/// intensity, 2 intensity + alpha, 3 RGB, 4 RGBA.
struct Image {
  std::uint32_t width = 0, height = 0, components = 0;
  std::vector<std::uint8_t> pixels;  // width * height * components
  std::uint32_t reduction = 1;       // file pixels per pixel in each direction
  std::uint64_t version = 0;         // images that change in place: changes with the pixels

  [[nodiscard]] bool empty() const { return pixels.empty(); }
  [[nodiscard]] bool has_alpha() const { return components == 2 || components == 4; }
};

/// Use of an image: a node, and the index of the url field in NodeType::url_fields (ImageTexture has one, Background
/// six).
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
/// Images by use. Images that have not loaded or are broken are absent.
using Images = std::unordered_map<ImagePlace, std::shared_ptr<const Image>, HashImagePlace>;

/// Error of a decoder, with the expected input.
struct ImageError {
  std::string message;
};

/// Limits of decoding.
struct ImageLimits {
  std::size_t file_pixels = std::size_t{1} << 28;    // larger images are refused, since unpacking takes too long
  std::size_t kept_pixels = std::size_t{1} << 28;    // larger images are scaled down while unpacking
  std::size_t working_bytes = std::size_t{1} << 29;  // additional memory of a decoder
  std::function<bool()> stopped = {};                // polled per row; true cancels. Null means never
};

/// Decodes PNG, JPEG, GIF, movies (first frame), BMP, binary PPM and PGM, and Targa, recognized by their first bytes.
/// Grey JPEG becomes intensity; PNG and GIF palettes follow VRML97 4.6.11.2. Accepts untrusted input; `limits` bounds
/// memory. A truncated JPEG or PNG gives the received rows.
[[nodiscard]] std::variant<Image, ImageError> decode_image(std::span<const std::byte> bytes,
                                                           const ImageLimits& limits = {});

/// Encodes an image of 1 to 4 components as PNG. `dots_per_inch` is stored as print resolution; 0 means none.
[[nodiscard]] std::vector<std::byte> encode_png(const Image& image, double dots_per_inch = 0);

// Options of encode_jpeg.
struct JpegOptions {
  int quality = 90;          // 1 to 100
  bool full_chroma = false;  // full colour resolution
};
/// Encodes an image of 1 or 3 components as progressive JPEG. Returns no bytes if the image is too large.
[[nodiscard]] std::vector<std::byte> encode_jpeg(const Image& image, const JpegOptions& options = {});
/// Returns the ends of the scans of a JPEG file; in a progressive file, each scan refines the whole image. Accepts
/// untrusted input.
[[nodiscard]] std::vector<std::size_t> scan_ends(std::span<const std::byte> jpeg);

/// Writes a PNG in bands of rows and keeps only the compressed bytes.
class PngWriter {
 public:
  /// `components` is 1 to 4. If PNG or zlib cannot represent the size, `finish` returns no bytes.
  PngWriter(std::uint32_t width, std::uint32_t height, std::uint32_t components, double dots_per_inch = 0);
  /// Adds the next rows from the top: a band of equal width and component count.
  void add(const Image& band);
  /// Returns the bytes; none unless all rows were added.
  [[nodiscard]] std::vector<std::byte> finish();

 private:
  std::uint32_t width_, height_, components_, rows_ = 0;
  bool good_;
  std::uint32_t checksum_ = 1;       // Adler-32 of all rows
  std::vector<std::uint8_t> above_;  // last row of the previous band
  std::vector<std::byte> bytes_;
};

}  // namespace gs::render
