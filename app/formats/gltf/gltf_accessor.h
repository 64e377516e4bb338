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

/// Reads the accessors of a glTF asset (glTF 2.0 3.6), checking every range against the buffers. All component
/// types, normalised or not, strides, sparse ones, and those without data. What all reads together give is
/// bounded by a multiple of the asset's bytes, so that thousands of accessors on one buffer cost no more.
class GltfAccessors {
 public:
  /// `model` and `scene`, whose budget is drawn from, must outlive this.
  GltfAccessors(const tinygltf::Model& model, vrml::SceneGraph& scene);

  /// The components of all elements, `components` a piece, normalised integers as -1..1 or 0..1. Nothing, and
  /// `problem()`, where the accessor does not exist, has other components, or reaches beyond its buffer.
  /// `always_normalized` is for colours, whose integers mean nothing else.
  [[nodiscard]] std::optional<std::vector<float>> floats(int accessor, int components, bool always_normalized = false);
  /// Unsigned integers, one or four an element.
  [[nodiscard]] std::optional<std::vector<std::uint32_t>> integers(int accessor, int components);
  /// Number of components of an element, 0 where the accessor does not exist.
  [[nodiscard]] int components(int accessor) const;
  /// The bytes of a buffer view; empty where it is broken.
  [[nodiscard]] std::span<const unsigned char> view(int buffer_view) const;

  /// False, and `problem()`, when giving out this many more bytes would be too much.
  [[nodiscard]] bool charge(std::size_t bytes);
  /// What was wrong with the last read that gave nothing.
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
