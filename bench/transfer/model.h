#pragma once

#include "bench/shared/studio.h"
#include "qnv/base/description.h"
#include "render/image/image.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

namespace gs::bench {

/// Way to make a picture of a part of a transfer.
enum class Prefix : std::uint8_t {
  stream,  // the first bytes of a QNV stream
  world,   // the first bytes of a world
  none     // only the whole file can be drawn
};

/// Format in which the model is sent.
struct Format {
  std::string_view name;   // on the command line
  std::string_view title;  // in tables
  std::string_view file;   // sent file
  Prefix prefix = Prefix::none;
  bool cells = false;      // over UDP; otherwise HTTP
  bool one_range = false;  // requested as one range, so that the server does not compress it
};

/// Formats in the order of the tables. A new format needs a row here, and its file in Model::make.
inline constexpr std::array<Format, 9> kFormats{{
    {"records", "QNV records, HTTP", "records.qnv", Prefix::stream},
    {"packed", "QNV packed, HTTP", "packed.qnv", Prefix::stream},
    {"outlines", "Outline groups, HTTP", "outlines.qnv", Prefix::world},
    {"vrml", "VRML97, HTTP", "model.wrl", Prefix::world, false, true},
    {"gzip", "VRML97 gzip'd, HTTP", "model.wrl.gz", Prefix::world, false, true},
    {"draco", "Draco, HTTP", "model.drc", Prefix::none},
    {"cells-records", "QNV records, cells", "records.qnv", Prefix::stream, true},
    {"cells-packed", "QNV packed, cells", "packed.qnv", Prefix::stream, true},
    {"cells-outlines", "Outline groups, cells", "outlines.qnv", Prefix::world, true},
}};

/// Returns the row of a name, or null for an unknown one.
[[nodiscard]] constexpr const Format* format_named(std::string_view name) {
  for (const Format& format : kFormats)
    if (format.name == name) return &format;
  return nullptr;
}

/// Minimum SSIM of a usable picture.
inline constexpr double kUsable = 0.9;

struct ModelOptions {
  std::string file;              // of any type that opens as polygons; VRML97 is sent unchanged
  std::string folder;            // for all generated files; exists and is empty
  View view;                     // of all pictures
  int draco_bits = 11;           // per coordinate
  std::size_t packed_bytes = 0;  // 0 means twice the size of Draco's file
  std::size_t record_vectors = 125'000;
  double tolerance = 0.005;  // for outline groups, relative to the model's diagonal
};

/// Picture from a part of a transfer.
struct Shown {
  bool anything = false;  // at least one pixel that is not background
  PictureError error;     // relative to the picture of the mesh itself
};

/// Bytes of a file that a picture needs.
struct Thresholds {
  std::uint64_t size = 0;
  std::optional<std::uint64_t> first, usable;  // bytes for any picture; bytes for SSIM 0.9
  PictureError end;
};

/// Model with files in all formats, in a folder that can be served. Draws their pictures. One thread.
class Model {
 public:
  [[nodiscard]] static std::variant<std::unique_ptr<Model>, std::string> make(const ModelOptions& options,
                                                                              Studio& studio);
  /// Returns the folder to serve.
  [[nodiscard]] std::string folder() const { return options_.folder + "/served"; }
  /// Returns 0 for missing formats, as without Draco's programs.
  [[nodiscard]] std::uint64_t size(const Format& format) const;
  [[nodiscard]] std::size_t triangles() const { return triangles_; }
  /// Returns the number of vectors of the octree stream.
  [[nodiscard]] std::size_t packed_vectors() const { return packed_vectors_; }
  [[nodiscard]] std::size_t record_vectors() const { return record_vectors_; }

  [[nodiscard]] std::size_t outline_groups() const { return outline_groups_; }

  [[nodiscard]] Shown show(const render::RenderList& list) { return compare(list); }
  /// Decodes the first bytes of a format's file. Returns nullopt if they cannot be drawn.
  [[nodiscard]] std::optional<Shown> show(const Format& format, std::uint64_t bytes);
  [[nodiscard]] Thresholds thresholds(const Format& format);

 private:
  Model(const ModelOptions& options, Studio& studio) : options_(options), studio_(studio) {}
  [[nodiscard]] std::optional<std::string> make_world();
  [[nodiscard]] std::optional<std::string> make_streams(const render::RenderList& full);
  void take_draco(const std::string& base);
  [[nodiscard]] std::optional<std::string> make_outlines(const render::RenderList& full);
  [[nodiscard]] std::optional<Shown> show_world(const std::string& path, std::uint64_t bytes);
  [[nodiscard]] Shown compare(const render::RenderList& list);

  ModelOptions options_;
  Studio& studio_;
  float crease_angle_ = 0;
  WideBox bounds_;
  std::vector<render::Image> reference_;
  std::size_t triangles_ = 0, packed_vectors_ = 0, record_vectors_ = 0, outline_groups_ = 0;
};

/// Returns the smallest number from `low` to `high` with a monotonic property, within `step`. `high` must have it.
template <class Holds>
[[nodiscard]] std::uint64_t least(std::uint64_t low, std::uint64_t high, std::uint64_t step, const Holds& holds) {
  while (low < high && high - low >= step) {
    const std::uint64_t middle = low + (high - low) / 2;
    if (holds(middle))
      high = middle;
    else
      low = middle + 1;
  }
  return high;
}

}  // namespace gs::bench
