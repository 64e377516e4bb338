#include "vrml/inventor/shapes/faces.h"

#include "base/text.h"

#include <algorithm>
#include <utility>

namespace gs::vrml::inventor {
namespace {

// Reports whether all indices are below `count`.
bool in_range(const MFInt32& list, std::size_t count) {
  return std::all_of(list.begin(), list.end(),
                     [&](std::int32_t i) { return i < 0 || static_cast<std::size_t>(i) < count; });
}

// Reports whether both lists end their faces at the same entries.
bool same_shape(const MFInt32& a, const MFInt32& b) {
  const std::size_t size = std::min(a.size(), b.size());
  const std::size_t rest = std::max(a.size(), b.size()) - size;
  const MFInt32& longer = a.size() > size ? a : b;
  if (rest > 1 || (rest == 1 && longer.back() >= 0)) return false;
  for (std::size_t i = 0; i < size; ++i)
    if ((a[i] < 0) != (b[i] < 0)) return false;
  return true;
}

// Returns the entries that are not -1.
MFInt32 without_ends(const MFInt32& list) {
  MFInt32 kept;
  kept.reserve(list.size());
  for (const std::int32_t value : list)
    if (value >= 0) kept.push_back(value);
  return kept;
}

// Calls `value` for each corner with its entry, the number of the corner and the number of its face. Copies the ends of
// faces.
template <class Value>
MFInt32 per_corner(const MFInt32& index, Value value) {
  MFInt32 result;
  result.reserve(index.size());
  std::int32_t corner = 0;
  for (std::size_t i = 0; i < index.size(); ++i) {
    if (index[i] < 0)
      result.push_back(-1);
    else
      result.push_back(value(i, corner++));
  }
  return result;
}

// Brings the indices into the range. Returns false if that is not allowed.
bool limit(MFInt32& list, std::size_t count, bool cycles) {
  if (in_range(list, count)) return true;
  if (!cycles || count == 0) return false;
  std::int32_t* values = list.mutable_data();
  for (std::size_t i = 0; i < list.size(); ++i)
    if (values[i] >= 0) values[i] = static_cast<std::int32_t>(static_cast<std::size_t>(values[i]) % count);
  return true;
}

bool is_unset(const MFInt32& own) { return own.empty() || (own.size() == 1 && own[0] < 0); }

AttributeIndex per_vertex_index(const FaceList& faces, bool indexed, const MFInt32& own) {
  AttributeIndex result;
  if (!indexed) {
    result.index = faces.vertex.empty()
                       ? per_corner(faces.index, [](std::size_t, std::int32_t corner) { return corner; })
                       : faces.vertex;
    return result;
  }
  if (is_unset(own)) {
    result.index = faces.index;
    return result;
  }
  if (faces.entry.empty() && same_shape(faces.index, own)) {
    result.index = own;
    return result;
  }
  result.index = per_corner(faces.index, [&](std::size_t i, std::int32_t) {
    const std::size_t entry = faces.entry.empty() ? i : static_cast<std::size_t>(std::max(faces.entry[i], 0));
    return entry < own.size() && own[entry] >= 0 ? own[entry] : faces.index[i];
  });
  return result;
}

}  // namespace

std::size_t FaceList::count() const {
  const auto ends = static_cast<std::size_t>(std::count_if(index.begin(), index.end(), [](auto i) { return i < 0; }));
  return ends + (!index.empty() && index.back() >= 0 ? 1 : 0);
}

void FaceList::corner(std::int32_t coordinate, std::int32_t number, std::int32_t own_entry) {
  index.push_back(coordinate);
  vertex.push_back(number);
  if (own_entry >= 0) entry.push_back(own_entry);
}

void FaceList::end_face(std::int32_t part_number) {
  index.push_back(-1);
  vertex.push_back(-1);
  if (!entry.empty()) entry.push_back(-1);
  part.push_back(part_number);
}

std::optional<AttributeIndex> attribute_index(const FaceList& faces, Binding binding, const MFInt32& own,
                                              std::size_t count, bool cycles) {
  if (count == 0 || (binding == Binding::overall && cycles)) return std::nullopt;
  AttributeIndex result;
  switch (binding) {
    case Binding::per_vertex:
    case Binding::per_vertex_indexed: {
      result = per_vertex_index(faces, binding == Binding::per_vertex_indexed, own);
      if (!limit(result.index, count, cycles)) return std::nullopt;
      if (result.index.shares_with(faces.index)) result.index.clear();
      return result;
    }
    case Binding::overall:
      result.per_vertex = false;
      result.index.resize(faces.count());
      return result;
    default:
      break;
  }
  result.per_vertex = false;
  const bool by_part = binding == Binding::per_part || binding == Binding::per_part_indexed;
  const bool indexed = binding == Binding::per_part_indexed || binding == Binding::per_face_indexed;
  const MFInt32& numbers = by_part ? faces.part : faces.face;
  const MFInt32 chosen = indexed && !is_unset(own) ? without_ends(own) : MFInt32();
  const std::size_t size = faces.count();
  if (numbers.empty() && chosen.empty() && size <= count) return result;  // in order
  result.index.reserve(size);
  for (std::size_t i = 0; i < size; ++i) {
    std::int32_t number = i < numbers.size() ? numbers[i] : static_cast<std::int32_t>(i);
    if (!chosen.empty()) {
      const auto at = static_cast<std::size_t>(std::max(number, 0));
      number = at < chosen.size() ? chosen[at] : chosen.back();
    }
    result.index.push_back(number);
  }
  if (!limit(result.index, count, cycles)) return std::nullopt;
  return result;
}

Binding binding_named(std::string_view name, Binding otherwise) {
  static constexpr std::pair<std::string_view, Binding> kNames[] = {
      {"OVERALL", Binding::overall},       {"NONE", Binding::overall},
      {"PER_PART", Binding::per_part},     {"PER_PART_INDEXED", Binding::per_part_indexed},
      {"PER_FACE", Binding::per_face},     {"PER_FACE_INDEXED", Binding::per_face_indexed},
      {"PER_VERTEX", Binding::per_vertex}, {"PER_VERTEX_INDEXED", Binding::per_vertex_indexed},
  };
  return value_named(kNames, name).value_or(otherwise);
}

Binding without_index(Binding binding) {
  switch (binding) {
    case Binding::per_part_indexed:
      return Binding::per_part;
    case Binding::per_face_indexed:
      return Binding::per_face;
    case Binding::per_vertex_indexed:
      return Binding::per_vertex;
    default:
      return binding;
  }
}

}  // namespace gs::vrml::inventor
