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

/// Image with 8 bits per component, rows from the top, without padding. Components as in VRML97 4.6.11: 1 intensity, 2
/// intensity and alpha, 3 RGB, 4 RGBA.
struct Image {
  std::uint32_t width = 0, height = 0, components = 0;
  std::vector<std::uint8_t> pixels;  // bytes: width * height * components
  std::uint32_t reduction = 1;       // each pixel is the mean of this number of file pixels in each direction
  std::uint64_t version = 0;         // increases with each change of the pixels, for images such as movie frames
  /// Slices of a volume, or the six faces of a cube, one below the other. `height` is that of all of them.
  std::uint32_t slices = 1;
  bool cube = false;  // faces in the order +X -X +Y -Y +Z -Z of OpenGL, which is left-handed

  [[nodiscard]] bool empty() const { return pixels.empty(); }
  [[nodiscard]] bool has_alpha() const { return components == 2 || components == 4; }
};

/// Key of an image: the node that uses it, and the index of the url field in NodeType::url_fields. ImageTexture has one
/// url field, Background six.
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
/// Images by key. Images that are not loaded yet or are broken are missing.
using Images = std::unordered_map<ImagePlace, std::shared_ptr<const Image>, HashImagePlace>;

/// Reason why a decoder failed. The message names the expected input.
struct ImageError {
  std::string message;
};

/// Limits of a decoder.
struct ImageLimits {
  std::size_t file_pixels = std::size_t{1} << 28;    // maximum pixels; decoding more takes too long
  std::size_t kept_pixels = std::size_t{1} << 28;    // images above this are scaled down while decoding
  std::size_t working_bytes = std::size_t{1} << 29;  // maximum additional memory of a decoder
  std::function<bool()> stopped = {};                // called once per row; returns true to cancel. Null never cancels
};

/// Decodes PNG, JPEG, GIF, movies (first frame), BMP, binary PPM and PGM, SGI, Targa, DDS, and NRRD volumes. Detects
/// the format by the first bytes. Grey JPEG becomes intensity; palettes of PNG and GIF follow VRML97 4.6.11.2. A
/// truncated JPEG or PNG gives the received rows.
///
/// Safe for untrusted bytes; `limits` bounds memory.
[[nodiscard]] std::variant<Image, ImageError> decode_image(std::span<const std::byte> bytes,
                                                           const ImageLimits& limits = {});

/// Encodes an image of 1 to 4 components as PNG. `dots_per_inch` is stored as the print resolution; 0 stores none.
[[nodiscard]] std::vector<std::byte> encode_png(const Image& image, double dots_per_inch = 0);

// Options of encode_jpeg().
struct JpegOptions {
  int quality = 90;          // 1 to 100
  bool full_chroma = false;  // stores colour at full resolution
};
/// Encodes an image of 1 or 3 components as progressive JPEG. Returns no bytes if the image is too large for the
/// format.
[[nodiscard]] std::vector<std::byte> encode_jpeg(const Image& image, const JpegOptions& options = {});
/// Returns the byte offsets at which the scans of a JPEG file end. In a progressive file, each scan refines the whole
/// image. Safe for untrusted bytes.
[[nodiscard]] std::vector<std::size_t> scan_ends(std::span<const std::byte> jpeg);

/// Encodes a PNG in bands of rows. Keeps only the compressed bytes.
class PngWriter {
 public:
  /// Starts a PNG with 1 to 4 components. If PNG or zlib cannot represent the size, `finish` returns no bytes.
  PngWriter(std::uint32_t width, std::uint32_t height, std::uint32_t components, double dots_per_inch = 0);
  /// Adds the next rows, from the top: a band of the same width and components.
  void add(const Image& band);
  /// Returns the bytes of the file. Returns no bytes if rows are missing.
  [[nodiscard]] std::vector<std::byte> finish();

 private:
  std::uint32_t width_, height_, components_, rows_ = 0;
  bool good_;
  std::uint32_t checksum_ = 1;       // Adler-32 checksum of all rows
  std::vector<std::uint8_t> above_;  // last row of the previous band
  std::vector<std::byte> bytes_;
};

}  // namespace gs::render
