#pragma once

#include "vrml/scene/values/field_value.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

namespace gs::vrml {

/// Relation between the values of a Color, Normal or TextureCoordinate node and the corners of faces or polylines in a
/// coordIndex (VRML97 6.23, 6.24).
enum class Binding : std::uint8_t {
  none,           // there are no values
  by_vertex,      // one value per coordinate, chosen by the index in coordIndex
  by_corner,      // chosen by the attribute's own index, at the same position as in coordIndex
  by_face,        // one value per face, in order
  by_face_index,  // one value per face, chosen by the attribute's own index
};

/// Index that marks a corner without a value.
inline constexpr std::uint32_t kMissing = 0xffffffff;

/// Values of an attribute, its index field, and the binding that relates them to corners.
template <class T>
struct Attribute {
  Array<T> values;
  MFInt32 index;
  Binding binding = Binding::none;

  Attribute() = default;
  /// `per_vertex` is colorPerVertex or normalPerVertex of the node; `indices` is its index field for the attribute.
  Attribute(Array<T> all, bool per_vertex, MFInt32 indices) : values(std::move(all)), index(std::move(indices)) {
    if (values.empty()) return;
    binding = per_vertex ? (index.empty() ? Binding::by_vertex : Binding::by_corner)
                         : (index.empty() ? Binding::by_face : Binding::by_face_index);
  }

  /// Returns a valid index in `values`, or kMissing. `corner` is a position in coordIndex, `vertex` the index stored
  /// there, and `face` the index of the face.
  [[nodiscard]] std::uint32_t find(std::size_t corner, std::uint32_t vertex, std::size_t face) const {
    std::uint32_t wanted = kMissing;
    switch (binding) {
      case Binding::none:
        return kMissing;
      case Binding::by_vertex:
        wanted = vertex;
        break;
      case Binding::by_corner:
        wanted = corner < index.size() ? static_cast<std::uint32_t>(index[corner]) : kMissing;
        break;
      case Binding::by_face:
        wanted = static_cast<std::uint32_t>(face);
        break;
      case Binding::by_face_index:
        wanted = face < index.size() ? static_cast<std::uint32_t>(index[face]) : kMissing;
        break;
    }
    return wanted < values.size() ? wanted : kMissing;
  }

  /// Like find(), but replaces a missing value: by the value of the vertex, or else by the last value. Returns kMissing
  /// only if there are no values.
  [[nodiscard]] std::uint32_t find_or_nearest(std::size_t corner, std::uint32_t vertex, std::size_t face) const {
    const std::uint32_t found = find(corner, vertex, face);
    if (found != kMissing || values.empty()) return found;
    return vertex < values.size() ? vertex : static_cast<std::uint32_t>(values.size() - 1);
  }

  /// Changes the binding from by_corner to by_vertex if the index field equals coordIndex, which many exporters write.
  /// The mesh can then share arrays.
  void simplify(std::span<const std::int32_t> coord_index);

  /// Resizes a by_vertex attribute to `count` values, and pads it with `filling`. If the size is right, keeps the
  /// shared storage.
  void fit(std::size_t count, T filling) {
    const std::size_t had = values.size();
    if (had == count) return;
    if (had > count) {
      values = Array<T>(values.span().first(count));
      return;
    }
    values.resize(count);
    T* all = values.mutable_data();
    for (std::size_t i = had; i < count; ++i) all[i] = filling;
  }
};

template <class T>
void Attribute<T>::simplify(std::span<const std::int32_t> coord_index) {
  if (binding != Binding::by_corner || index.size() < coord_index.size()) {
    // The end marker of the last face may be missing in either index.
    if (binding != Binding::by_corner || index.size() + 1 != coord_index.size() || coord_index.back() >= 0) return;
    coord_index = coord_index.first(index.size());
  }
  if (coord_index.empty() || std::memcmp(index.data(), coord_index.data(), coord_index.size_bytes()) != 0) return;
  index.clear();
  binding = Binding::by_vertex;
}

}  // namespace gs::vrml
