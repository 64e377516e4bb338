#pragma once

#include "vrml/scene/array.h"
#include "vrml/scene/diagnostic.h"
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

/// An importer needs more memory than its scene may take, or the time is over. `import_mesh` takes it.
class OutOfBudget : public std::exception {};

/// Draws memory that the scene, or the work for it, takes; throws OutOfBudget.
inline void draw(vrml::SceneGraph& scene, std::uint64_t bytes) {
  if (!scene.charge(static_cast<std::size_t>(bytes)) || scene.budget()->stopped()) throw OutOfBudget();
}

/// Fills a vrml::Array one value at a time, without its checks for every value. `take` ends it. Throws OutOfBudget.
template <class T>
requires std::is_trivially_copyable_v<T>
class Appender {
 public:
  /// For a field of `scene`, which outlives it.
  explicit Appender(vrml::SceneGraph& scene) : scene_(&scene) {}

  void push(const T& value) {
    if (next_ == end_) grow();
    *next_++ = value;
  }
  [[nodiscard]] std::size_t size() const { return array_.size() + static_cast<std::size_t>(next_ - first_); }
  [[nodiscard]] bool empty() const { return size() == 0; }
  /// The last `count` values given; count <= size() and no `push` between.
  [[nodiscard]] T* last(std::size_t count) {
    flush();
    return array_.mutable_data() + (array_.size() - count);
  }
  /// Forgets the last `count` values.
  void drop(std::size_t count) {
    flush();
    array_.resize(array_.size() - count);
    first_ = next_ = end_ = nullptr;
  }
  /// Appends copies of `value` until there are `size` of them.
  void fill(std::size_t size, const T& value) {
    while (this->size() < size) push(value);
  }
  [[nodiscard]] vrml::Array<T> take() {
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
    constexpr std::size_t kFirst = 256, kMost = std::size_t{1} << 18;  // between two looks at the budget
    const std::size_t more = std::clamp(array_.size(), kFirst, kMost);
    draw(*scene_, more * sizeof(T));
    first_ = next_ = array_.prepare(more);
    end_ = next_ + more;
  }

  vrml::SceneGraph* scene_;
  vrml::Array<T> array_;
  T* first_ = nullptr;  // what array_ does not count yet begins here
  T* next_ = nullptr;
  T* end_ = nullptr;
};

/// An index that no array reaches; stands for one that the file has wrong until the face is dropped.
inline constexpr std::int32_t kBadIndex = std::numeric_limits<std::int32_t>::max();
/// Ends a face or a line in an index array (VRML97 6.23).
inline constexpr std::int32_t kFaceEnd = -1;

/// What an importer has of one IndexedFaceSet, IndexedLineSet or PointSet, in the arrays of those nodes
/// (VRML97 6.23, 6.24, 6.36). normal_index and texture_index may be
/// empty: then coord_index stands in.
struct Geometry {
  enum class Kind : std::uint8_t { faces, lines, points };

  Kind kind = Kind::faces;
  vrml::MFVec3f positions;
  vrml::MFVec3f normals;
  vrml::MFColor colors;  // one a position, or one a face where color_per_vertex is false
  vrml::MFVec2f texture_coordinates;
  vrml::MFInt32 coord_index, normal_index, texture_index;
  bool color_per_vertex = true;
  bool solid = false;
  bool convex = true;
  float crease_angle = 0;
};

/// A Material in display space (VRML97 6.27), with a texture where `texture_url` is not empty.
struct Look {
  vrml::Color diffuse{0.8f, 0.8f, 0.8f}, specular{}, emissive{};
  float ambient_intensity = 0.2f, shininess = 0.2f, transparency = 0.0f;
  bool lit = true;  // false: no Material at all (VRML97 Table 4.5)
  vrml::String texture_url;
  bool repeat_s = true, repeat_t = true;
};

/// The same for lines and points, which show their emission and nothing else (VRML97 4.14.2).
[[nodiscard]] Look glowing(Look look);

/// Makes the nodes that the importers need, and reports. Every function takes null NodeIds, which
/// creating gives when the scene's limit of nodes is reached, and does nothing with them.
class SceneBuilder {
 public:
  SceneBuilder(vrml::SceneGraph& scene, vrml::Diagnostics& diagnostics) : scene_(scene), diagnostics_(diagnostics) {}

  [[nodiscard]] vrml::SceneGraph& scene() { return scene_; }

  /// Null, with one diagnostic for all, when no more nodes are allowed.
  vrml::NodeId make(vrml::NodeKind kind);
  template <class T>
  void set(vrml::NodeId node, std::string_view field, T value) {
    if (node) scene_.set<T>(node, field, std::move(value));
  }
  /// Gives a DEF name made of `text`: letters the standard forbids become '_', and it is made unique.
  void name(vrml::NodeId node, std::string_view text);
  void add_root(vrml::NodeId node) {
    if (node) scene_.add_root(node);
  }

  [[nodiscard]] vrml::NodeId appearance(const Look& look);
  /// Drops faces, lines and points that use missing or non-finite coordinates, with a warning each kind;
  /// null when nothing is left.
  [[nodiscard]] vrml::NodeId geometry(Geometry data);
  [[nodiscard]] vrml::NodeId shape(vrml::NodeId geometry, vrml::NodeId appearance);

  void report(vrml::Severity severity, std::string message, vrml::SourceLocation location = {});
  void note(std::string message, vrml::SourceLocation at = {}) { report(vrml::Severity::note, std::move(message), at); }
  void warn(std::string message, vrml::SourceLocation at = {}) {
    report(vrml::Severity::warning, std::move(message), at);
  }
  void fail(std::string message, vrml::SourceLocation at = {}) {
    report(vrml::Severity::error, std::move(message), at);
  }

 private:
  vrml::SceneGraph& scene_;
  vrml::Diagnostics& diagnostics_;
  std::unordered_set<std::string> names_;
  bool full_ = false;
};

/// The colour that a display shows for linear light (IEC 61966-2-1), both 0..1.
[[nodiscard]] float display_of_linear(float linear);

}  // namespace gs::app
