#pragma once

#include "vrml/scene/field_value.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

namespace gs::vrml {

/// How the values of a Color, Normal or TextureCoordinate node meet the corners of the faces or
/// polylines of a coordIndex (VRML97 6.23, 6.24).
enum class Binding : std::uint8_t {
  none,           // there are no values
  by_vertex,      // one a coordinate, chosen by coordIndex
  by_corner,      // chosen by an index that stands where the corner's coordIndex stands
  by_face,        // one a face, in order
  by_face_index,  // one a face, chosen by the face's index
};

/// No value for this corner.
inline constexpr std::uint32_t kMissing = 0xffffffff;

/// Values, the node's index field for them, and what the two mean together.
template <class T>
struct Attribute {
  Array<T> values;
  MFInt32 index;
  Binding binding = Binding::none;

  Attribute() = default;
  /// `per_vertex` is the node's field of that name; `index` its xxxIndex.
  Attribute(Array<T> all, bool per_vertex, MFInt32 indices) : values(std::move(all)), index(std::move(indices)) {
    if (values.empty()) return;
    binding = per_vertex ? (index.empty() ? Binding::by_vertex : Binding::by_corner)
                         : (index.empty() ? Binding::by_face : Binding::by_face_index);
  }

  /// Place of the value in `values`, always inside it, or kMissing. `corner` is a place in
  /// coordIndex, `vertex` what stands there, `face` the ordinal of the face.
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

  /// The same, but where the value is missing the one of the vertex itself or the last one; kMissing
  /// only when there are none.
  [[nodiscard]] std::uint32_t find_or_nearest(std::size_t corner, std::uint32_t vertex, std::size_t face) const {
    const std::uint32_t found = find(corner, vertex, face);
    if (found != kMissing || values.empty()) return found;
    return vertex < values.size() ? vertex : static_cast<std::uint32_t>(values.size() - 1);
  }

  /// Exporters often write the coordIndex a second time. Says so by the binding, which allows sharing.
  void simplify(std::span<const std::int32_t> coord_index);

  /// Brings a by_vertex attribute to `count` values, sharing them if they are so many already. Adds `filling`.
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
    // The end marker of the last face may be left out on either side.
    if (binding != Binding::by_corner || index.size() + 1 != coord_index.size() || coord_index.back() >= 0) return;
    coord_index = coord_index.first(index.size());
  }
  if (coord_index.empty() || std::memcmp(index.data(), coord_index.data(), coord_index.size_bytes()) != 0) return;
  index.clear();
  binding = Binding::by_vertex;
}

}  // namespace gs::vrml
