#pragma once

#include "vrml/scene/scene_graph.h"

#include <tiny_gltf.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Reader of glTF accessors (glTF 2.0 3.6). Checks each range against the buffers. Supports all component types,
/// normalised integers, strides, sparse accessors, and accessors without data. The total output is bounded by a
/// multiple of the asset's size. Thus many accessors on one buffer cannot exhaust memory.
class GltfAccessors {
 public:
  /// `model` and `scene` must outlive this object. Memory is charged to the scene's budget.
  GltfAccessors(const tinygltf::Model& model, vrml::SceneGraph& scene);

  /// Returns the components of all elements, `components` per element. Normalised integers become -1..1 or 0..1.
  /// Returns nullopt and sets `problem()` if the accessor is missing, has another number of components, or exceeds its
  /// buffer. `always_normalized` is for colours, where all integers are normalised.
  [[nodiscard]] std::optional<std::vector<float>> floats(int accessor, int components, bool always_normalized = false);
  /// Returns unsigned integers; `components` is 1 or 4. Returns nullopt and sets `problem()` like floats().
  [[nodiscard]] std::optional<std::vector<std::uint32_t>> integers(int accessor, int components);
  /// Returns the number of components per element; 0 if the accessor does not exist.
  [[nodiscard]] int components(int accessor) const;
  /// Returns the bytes of a buffer view. Empty if the view is invalid.
  [[nodiscard]] std::span<const unsigned char> view(int buffer_view) const;

  /// Charges output bytes to the limit. If the limit is exceeded, sets `problem()` and returns false.
  [[nodiscard]] bool charge(std::size_t bytes);
  /// Error message of the last read that failed.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  struct Source;
  template <class T>
  std::optional<std::vector<T>> read(int accessor, int components, bool always_normalized);
  template <class T>
  bool read_sparse(const tinygltf::Accessor& accessor, bool normalized, std::vector<T>& values, int components);
  bool make_source(std::span<const unsigned char> bytes, std::size_t offset, std::size_t count, std::size_t stride,
                   int component_type, int components, Source& source);

  const tinygltf::Model& model_;
  vrml::SceneGraph& scene_;
  std::size_t budget_;
  std::string problem_;
};

}  // namespace gs::app
