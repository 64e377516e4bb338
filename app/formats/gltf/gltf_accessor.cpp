#include "app/formats/gltf/gltf_accessor.h"

#include "base/nth_type.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <type_traits>

namespace gs::app {
namespace {

// Max output bytes per byte of the asset. Typical assets read each byte about once; a byte becomes at most one float or
// index.
constexpr std::size_t kMaxUses = 64;
constexpr std::size_t kSmallBudget = std::size_t{64} << 20;

std::size_t size_of(int component_type) {
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_INT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    case TINYGLTF_COMPONENT_TYPE_DOUBLE:
      return 8;
    default:
      return 0;
  }
}

int component_count(int type) {
  switch (type) {
    case TINYGLTF_TYPE_SCALAR:
      return 1;
    case TINYGLTF_TYPE_VEC2:
      return 2;
    case TINYGLTF_TYPE_VEC3:
      return 3;
    case TINYGLTF_TYPE_VEC4:
      return 4;
    case TINYGLTF_TYPE_MAT4:
      return 16;
    default:
      return 0;
  }
}

template <class T>
T raw(const unsigned char* from) {
  T value;
  std::memcpy(&value, from, sizeof(T));
  return value;
}

/// Converts a component to float. Normalised integers become -1..1 if signed, else 0..1 (glTF 2.0 3.11).
template <class T>
float as_float(const unsigned char* from, bool normalized) {
  const T value = raw<T>(from);
  if constexpr (std::is_floating_point_v<T>) return static_cast<float>(value);
  const auto number = static_cast<float>(value);
  return normalized ? std::max(number / static_cast<float>(std::numeric_limits<T>::max()), -1.0f) : number;
}

template <class T>
std::uint32_t as_unsigned(const unsigned char* from) {
  const T value = raw<T>(from);
  // Invalid values become an index that is always out of range.
  constexpr double kMax = std::numeric_limits<std::uint32_t>::max();
  if (!(static_cast<double>(value) >= 0 && static_cast<double>(value) < kMax))
    return std::numeric_limits<std::uint32_t>::max();
  return static_cast<std::uint32_t>(value);
}

template <class To>
To component(const unsigned char* from, int component_type, bool normalized) {
  const auto as = [&](auto kind) -> To {
    using From = decltype(kind);
    if constexpr (std::is_same_v<To, float>)
      return as_float<From>(from, normalized);
    else
      return as_unsigned<From>(from);
  };
  if (component_type == TINYGLTF_COMPONENT_TYPE_DOUBLE) return as(double{});
  return with_nth_type<std::int8_t, std::uint8_t, std::int16_t, std::uint16_t, std::int32_t, std::uint32_t, float>(
      static_cast<std::size_t>(component_type - TINYGLTF_COMPONENT_TYPE_BYTE), as);
}

}  // namespace

/// Elements of a buffer, with a checked range.
struct GltfAccessors::Source {
  const unsigned char* first = nullptr;
  std::size_t stride = 0;
  std::size_t component_size = 0;
};

GltfAccessors::GltfAccessors(const tinygltf::Model& model, vrml::SceneGraph& scene) : model_(model), scene_(scene) {
  std::size_t total = 0;
  for (const tinygltf::Buffer& buffer : model.buffers) total += buffer.data.size();
  budget_ = kSmallBudget + kMaxUses * total;
}

bool GltfAccessors::charge(std::size_t bytes) {
  if (bytes > budget_) {
    problem_ = "the asset refers to its data too many times";
    return false;
  }
  if (!scene_.memory().charge(bytes)) {
    problem_ = scene_.budget()->refusal(Resource::nodes);
    return false;
  }
  budget_ -= bytes;
  return true;
}

int GltfAccessors::components(int accessor) const {
  if (accessor < 0 || static_cast<std::size_t>(accessor) >= model_.accessors.size()) return 0;
  return component_count(model_.accessors[static_cast<std::size_t>(accessor)].type);
}

std::span<const unsigned char> GltfAccessors::view(int buffer_view) const {
  if (buffer_view < 0 || static_cast<std::size_t>(buffer_view) >= model_.bufferViews.size()) return {};
  const tinygltf::BufferView& view = model_.bufferViews[static_cast<std::size_t>(buffer_view)];
  if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model_.buffers.size()) return {};
  const std::vector<unsigned char>& data = model_.buffers[static_cast<std::size_t>(view.buffer)].data;
  if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset) return {};
  return std::span(data).subspan(view.byteOffset, view.byteLength);
}

bool GltfAccessors::make_source(std::span<const unsigned char> bytes, std::size_t offset, std::size_t count,
                                std::size_t stride, int component_type, int components, Source& source) {
  source.component_size = size_of(component_type);
  const std::size_t element = source.component_size * static_cast<std::size_t>(components);
  source.stride = stride == 0 ? element : stride;
  if (element == 0 || source.stride < element) {
    problem_ = "unknown component type, or a stride smaller than an element";
    return false;
  }
  if (bytes.empty() || offset > bytes.size() || bytes.size() - offset < element ||
      (count - 1) > (bytes.size() - offset - element) / source.stride) {
    problem_ = "the data exceed their buffer view";
    return false;
  }
  source.first = bytes.data() + offset;
  return true;
}

template <class T>
std::optional<std::vector<T>> GltfAccessors::read(int index, int components, bool always_normalized) {
  if (index < 0 || static_cast<std::size_t>(index) >= model_.accessors.size()) {
    problem_ = "accessor " + std::to_string(index) + " does not exist";
    return std::nullopt;
  }
  const tinygltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(index)];
  if (component_count(accessor.type) != components) {
    problem_ = "expected " + std::to_string(components) + " components, found " +
               std::to_string(component_count(accessor.type));
    return std::nullopt;
  }
  const auto width = static_cast<std::size_t>(components);
  if (accessor.count == 0) return std::vector<T>();
  if (accessor.count > std::numeric_limits<std::int32_t>::max() || !charge(accessor.count * width * sizeof(T))) {
    problem_ = "more elements than the file can hold";
    return std::nullopt;
  }
  const bool normalized = accessor.normalized || always_normalized;
  Source source;
  const bool has_data = accessor.bufferView >= 0;
  if (has_data) {
    const auto bytes = view(accessor.bufferView);
    const std::size_t stride =
        bytes.empty() ? 0 : model_.bufferViews[static_cast<std::size_t>(accessor.bufferView)].byteStride;
    if (!make_source(bytes, accessor.byteOffset, accessor.count, stride, accessor.componentType, components, source))
      return std::nullopt;
  }
  // Without a buffer view, all values are zero (glTF 2.0 3.6.2.1).
  std::vector<T> values(accessor.count * width);
  if (has_data)
    for (std::size_t i = 0; i < accessor.count; ++i)
      for (std::size_t c = 0; c < width; ++c)
        values[i * width + c] = component<T>(source.first + i * source.stride + c * source.component_size,
                                             accessor.componentType, normalized);
  if (accessor.sparse.isSparse && !read_sparse(accessor, normalized, values, components)) return std::nullopt;
  return values;
}

template <class T>
bool GltfAccessors::read_sparse(const tinygltf::Accessor& accessor, bool normalized, std::vector<T>& values,
                                int components) {
  const auto& sparse = accessor.sparse;
  if (sparse.count <= 0 || static_cast<std::size_t>(sparse.count) > accessor.count || sparse.indices.byteOffset < 0 ||
      sparse.values.byteOffset < 0) {
    problem_ = "broken sparse accessor";
    return false;
  }
  const auto count = static_cast<std::size_t>(sparse.count), width = static_cast<std::size_t>(components);
  Source where, what;
  if (!make_source(view(sparse.indices.bufferView), static_cast<std::size_t>(sparse.indices.byteOffset), count, 0,
                   sparse.indices.componentType, 1, where) ||
      !make_source(view(sparse.values.bufferView), static_cast<std::size_t>(sparse.values.byteOffset), count, 0,
                   accessor.componentType, components, what))
    return false;
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = component<std::uint32_t>(where.first + i * where.stride, sparse.indices.componentType, false);
    if (at >= accessor.count) {
      problem_ = "a sparse index exceeds the accessor";
      return false;
    }
    for (std::size_t c = 0; c < width; ++c)
      values[at * width + c] =
          component<T>(what.first + i * what.stride + c * what.component_size, accessor.componentType, normalized);
  }
  return true;
}

std::optional<std::vector<float>> GltfAccessors::floats(int accessor, int components, bool always_normalized) {
  return read<float>(accessor, components, always_normalized);
}

std::optional<std::vector<std::uint32_t>> GltfAccessors::integers(int accessor, int components) {
  return read<std::uint32_t>(accessor, components, false);
}

}  // namespace gs::app
