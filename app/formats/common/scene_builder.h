#pragma once

#include "base/array.h"
#include "base/diagnostic.h"
#include "vrml/scene/field_value.h"
#include "vrml/scene/scene_graph.h"

#include <algorithm>
#include <cstdint>
#include <exception>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <unordered_set>
#include <utility>

namespace gs::app {

/// Exception for an importer that exceeds its memory budget or time limit. `import_mesh` catches it.
class OutOfBudget : public std::exception {};

/// Charges memory of the scene or the import to the budget. Throws OutOfBudget.
inline void draw(vrml::SceneGraph& scene, std::uint64_t bytes) {
  if (!scene.charge(static_cast<std::size_t>(bytes)) || scene.budget()->stopped()) throw OutOfBudget();
}

/// Fast builder of a Array without per-value checks; finish with `take`. Throws OutOfBudget.
template <class T>
requires std::is_trivially_copyable_v<T>
class Appender {
 public:
  /// Creates a builder for a field of `scene`, which must outlive it.
  explicit Appender(vrml::SceneGraph& scene) : scene_(&scene) {}

  void push(const T& value) {
    if (next_ == end_) grow();
    *next_++ = value;
  }
  [[nodiscard]] std::size_t size() const { return array_.size() + static_cast<std::size_t>(next_ - first_); }
  [[nodiscard]] bool empty() const { return size() == 0; }
  /// Returns the last `count` values; count <= size(). Valid until the next `push`.
  [[nodiscard]] T* last(std::size_t count) {
    flush();
    return array_.mutable_data() + (array_.size() - count);
  }
  /// Removes the last `count` values.
  void drop(std::size_t count) {
    flush();
    array_.resize(array_.size() - count);
    first_ = next_ = end_ = nullptr;
  }
  /// Appends copies of `value` up to `size` values.
  void fill(std::size_t size, const T& value) {
    while (this->size() < size) push(value);
  }
  [[nodiscard]] Array<T> take() {
    flush();
    array_.shrink_to_fit();
    first_ = next_ = end_ = nullptr;
    return std::exchange(array_, {});
  }

 private:
  void flush() {
    array_.commit(static_cast<std::size_t>(next_ - first_));
    first_ = next_;
  }
  void grow() {
    flush();
    constexpr std::size_t kFirst = 256, kMax = std::size_t{1} << 18;  // values between two budget checks
    const std::size_t more = std::clamp(array_.size(), kFirst, kMax);
    draw(*scene_, more * sizeof(T));
    first_ = next_ = array_.prepare(more);
    end_ = next_ + more;
  }

  vrml::SceneGraph* scene_;
  Array<T> array_;
  T* first_ = nullptr;  // start of the values not yet counted by array_
  T* next_ = nullptr;
  T* end_ = nullptr;
};

/// Invalid index; marks a wrong index of the file until its face is removed.
inline constexpr std::int32_t kBadIndex = std::numeric_limits<std::int32_t>::max();
/// End marker of a face or line in an index array (VRML97 6.23).
inline constexpr std::int32_t kFaceEnd = -1;

/// Content of one IndexedFaceSet, IndexedLineSet or PointSet from an importer, in those nodes' arrays (VRML97 6.23,
/// 6.24, 6.36). If normal_index or texture_index is empty, coord_index applies.
struct Geometry {
  enum class Kind : std::uint8_t { faces, lines, points };

  Kind kind = Kind::faces;
  vrml::MFVec3f positions;
  vrml::MFVec3f normals;
  vrml::MFColor colors;  // per position, or per face if color_per_vertex is false
  vrml::MFVec2f texture_coordinates;
  vrml::MFInt32 coord_index, normal_index, texture_index;
  bool color_per_vertex = true;
  bool solid = false;
  bool convex = true;
  float crease_angle = 0;
};

/// Material in display colour space (VRML97 6.27), with a texture unless `texture_url` is empty.
struct Look {
  vrml::Color diffuse{0.8f, 0.8f, 0.8f}, specular{}, emissive{};
  float ambient_intensity = 0.2f, shininess = 0.2f, transparency = 0.0f;
  bool lit = true;  // false means no Material (VRML97 Table 4.5)
  vrml::String texture_url;
  bool repeat_s = true, repeat_t = true;
};

/// Converts a look for lines and points, which show only emission (VRML97 4.14.2).
[[nodiscard]] Look glowing(Look look);

/// Factory of nodes for importers, with diagnostics. Nodes are null once the scene's node limit is reached. All
/// functions accept null NodeIds and ignore them.
class SceneBuilder {
 public:
  SceneBuilder(vrml::SceneGraph& scene, Diagnostics& diagnostics) : scene_(scene), diagnostics_(diagnostics) {}

  [[nodiscard]] vrml::SceneGraph& scene() { return scene_; }

  /// Creates a node. Returns null, with one diagnostic in total, if the node limit is reached.
  vrml::NodeId make(vrml::NodeKind kind);
  template <class T>
  void set(vrml::NodeId node, std::string_view field, T value) {
    if (node) scene_.set<T>(node, field, std::move(value));
  }
  /// Gives the node a DEF name derived from `text`: replaces forbidden characters by '_' and makes it unique.
  void name(vrml::NodeId node, std::string_view text);
  void add_root(vrml::NodeId node) {
    if (node) scene_.add_root(node);
  }

  [[nodiscard]] vrml::NodeId appearance(const Look& look);
  /// Creates a geometry node. Drops faces, lines and points with missing or non-finite coordinates, with one warning
  /// per kind. Returns null if nothing is left.
  [[nodiscard]] vrml::NodeId geometry(Geometry data);
  [[nodiscard]] vrml::NodeId shape(vrml::NodeId geometry, vrml::NodeId appearance);

  void report(Severity severity, std::string message, SourceLocation location = {});
  void note(std::string message, SourceLocation at = {}) { report(Severity::note, std::move(message), at); }
  void warn(std::string message, SourceLocation at = {}) { report(Severity::warning, std::move(message), at); }
  void fail(std::string message, SourceLocation at = {}) { report(Severity::error, std::move(message), at); }

 private:
  vrml::SceneGraph& scene_;
  Diagnostics& diagnostics_;
  std::unordered_set<std::string> names_;
  bool full_ = false;
};

/// Converts linear light to display sRGB (IEC 61966-2-1), both 0..1.
[[nodiscard]] float display_of_linear(float linear);

}  // namespace gs::app
