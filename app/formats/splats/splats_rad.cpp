#include "app/formats/splats/splats_rad.h"
#include "app/formats/common/byte_order.h"
#include "app/formats/splats/splats.h"

#include <zlib.h>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

// Import of RAD version 1 (Spark): chunks of splats with compressed arrays of properties. The splats form a tree of
// levels of detail, stored from coarse to fine.
namespace gs::app {
namespace {

using RadJson = nlohmann::json;
using RadProblem = std::optional<std::string>;

constexpr std::uint32_t kRadMagic = 0x30444152, kRadChunkMagic = 0x43444152;  // "RAD0", "RADC"
constexpr std::size_t kMostRadMeta = std::size_t{16} << 20, kMostRadChunks = 1 << 20, kMostRadCodes = 1 << 20;
constexpr std::size_t kMostInflation = 1032;  // maximum bytes from one byte of deflated data
constexpr std::size_t kLeastCenterBytes = 6;  // minimum bytes of a position before it is deflated
constexpr std::size_t kMostRadProperties = 256;
constexpr std::uint64_t kMostRadSplats = std::uint64_t{1} << 31;

std::size_t rad_padded(std::size_t size) { return (size + 7) / 8 * 8; }

std::uint64_t rad_number(const RadJson& from, const char* key) {
  const auto found = from.find(key);
  return found != from.end() && found->is_number_unsigned() ? found->get<std::uint64_t>() : 0;
}

std::string rad_text(const RadJson& from, const char* key) {
  const auto found = from.find(key);
  return found != from.end() && found->is_string() ? found->get<std::string>() : std::string();
}

float rad_limit(const RadJson& from, const char* key, float usual) {
  const auto found = from.find(key);
  return found != from.end() && found->is_number() ? found->get<float>() : usual;
}

/// Head of a file or chunk: its JSON, and the offset of the data after it.
struct RadHead {
  RadJson meta;
  std::size_t end = 0;
};
std::optional<RadHead> read_rad_head(std::span<const std::byte> bytes, std::uint32_t magic) {
  if (bytes.size() < 8 || load_little<std::uint32_t>(bytes.data()) != magic) return std::nullopt;
  const std::size_t length = load_little<std::uint32_t>(bytes.data() + 4);
  if (length > kMostRadMeta || length > bytes.size() - 8) return std::nullopt;
  const auto* const text = reinterpret_cast<const char*>(bytes.data() + 8);
  RadHead head{RadJson::parse(text, text + length, nullptr, false), 8 + rad_padded(length)};
  if (!head.meta.is_object() || head.end > bytes.size()) return std::nullopt;
  return head;
}

/// Decoder of a property of a chunk. Its dimensions are stored one after the other.
class RadPlanes {
 public:
  RadPlanes(const RadJson& property, std::span<const std::byte> data)
      : encoding_(rad_text(property, "encoding")),
        least_(rad_limit(property, "min", 0)),
        most_(rad_limit(property, "max", 1)),
        data_(data) {}

  /// Returns the number of bytes of one value, or 0 for an unknown encoding.
  static std::size_t width_of(std::string_view encoding) {
    if (encoding == "f32" || encoding == "f32_lebytes" || encoding == "u32") return 4;
    if (encoding == "f16" || encoding == "f16_lebytes" || encoding == "ln_f16" || encoding == "u16") return 2;
    if (encoding == "r8" || encoding == "r8_delta" || encoding == "s8" || encoding == "s8_delta" ||
        encoding == "ln_0r8" || encoding == "oct88r8")
      return 1;
    return 0;
  }

  /// Calls use(i, k, value) for `count` splats with `dimensions` numbers. `data` must be long enough.
  template <class Use>
  void for_each(std::size_t dimensions, std::size_t count, const Use& use) const {
    const bool split = encoding_.ends_with("_lebytes"), delta = encoding_.ends_with("_delta");
    const std::size_t width = width_of(encoding_), all = dimensions * count;
    for (std::size_t k = 0; k < dimensions; ++k) {
      std::uint8_t last = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = k * count + i;
        std::array<std::byte, 4> raw{};
        for (std::size_t b = 0; b < width; ++b) raw[b] = data_[split ? b * all + at : at * width + b];
        if (delta)
          raw[0] = static_cast<std::byte>(last = static_cast<std::uint8_t>(last + std::to_integer<int>(raw[0])));
        use(i, k, value_of(raw.data()));
      }
    }
  }

 private:
  [[nodiscard]] float value_of(const std::byte* raw) const {
    const auto byte = std::to_integer<int>(*raw);
    if (encoding_.starts_with("f32")) return load_little<float>(raw);
    if (encoding_.starts_with("f16")) return float_of_half(load_little<std::uint16_t>(raw));
    if (encoding_ == "ln_f16") return std::exp(float_of_half(load_little<std::uint16_t>(raw)));
    if (encoding_ == "u16") return static_cast<float>(load_little<std::uint16_t>(raw));
    if (encoding_.starts_with("s8")) return static_cast<float>(static_cast<std::int8_t>(byte)) / 127 * most_;
    if (encoding_ == "ln_0r8")
      return byte == 0 ? 0.0f : std::exp(least_ + static_cast<float>(byte - 1) * (most_ - least_) / 254);
    return static_cast<float>(byte) / 255 * (most_ - least_) + least_;
  }

  std::string encoding_;
  float least_, most_;
  std::span<const std::byte> data_;
};

/// Decodes three bytes, an octahedral axis and an angle, to a quaternion x, y, z, w.
glm::vec4 rotation_of_oct88r8(const std::byte* raw) {
  const auto part = [&](int i) { return static_cast<float>(std::to_integer<int>(raw[i])) / 255; };
  glm::vec3 axis(part(0) * 2 - 1, part(1) * 2 - 1, 0);
  axis.z = 1 - std::abs(axis.x) - std::abs(axis.y);
  const float fold = std::max(-axis.z, 0.0f);
  for (int k = 0; k < 2; ++k) axis[k] += axis[k] >= 0 ? -fold : fold;
  const float half = part(2) * 0.5f * std::numbers::pi_v<float>;
  return glm::vec4(glm::normalize(axis) * std::sin(half), std::cos(half));
}

/// Reader of a RAD file.
class RadReader {
 public:
  explicit RadReader(const ImportSource& source) : source_(source), readable_(source.bytes.size()) {}

  /// Reads the complete chunks, as many as fit into memory, and keeps the finest splats. Returns a message if no splats
  /// remain.
  RadProblem read(SplatModel& model) {
    const auto head = read_rad_head(source_.bytes, kRadMagic);
    if (!head) return "its header is damaged";
    if (rad_number(head->meta, "version") != 1 || rad_text(head->meta, "type") != "gsplat")
      return "its version or type is not known; expected version 1 of splats";
    const auto chunks = head->meta.find("chunks");
    if (chunks == head->meta.end() || !chunks->is_array() || chunks->size() > kMostRadChunks)
      return "it has no list of chunks";
    model.format = "RAD";
    model.announced = static_cast<std::size_t>(std::min(rad_number(head->meta, "count"), kMostRadSplats));
    model.set_degree(static_cast<int>(std::min<std::uint64_t>(rad_number(head->meta, "maxSh"), 3)));
    for (const RadJson& chunk : *chunks) {
      auto problem = read_chunk(chunk, head->end, model);
      if (!problem) continue;
      if (model.size() == 0) return problem;
      source_.diagnostics.add({Severity::warning, source_.path, {}, "RAD: " + *problem + "; coarser splats remain"});
      break;
    }
    model.announced = std::min(model.announced, model.size());
    keep_finest(model);
    return std::nullopt;
  }

 private:
  RadProblem read_chunk(const RadJson& range, std::size_t start, SplatModel& model) {
    if (!range.is_object()) return "its list of chunks is damaged";
    std::span<const std::byte> bytes = source_.bytes;
    SharedBytes beside;
    if (const std::string name = rad_text(range, "filename"); !name.empty()) {
      if (name.find_first_of("/\\:?#%") != std::string::npos) return "it names a file in another folder: " + name;
      if (!source_.read_file) return name + " is not available";
      BytesResult file = source_.read_file(name);
      if (auto* problem = std::get_if<std::string>(&file)) return std::move(*problem);
      beside = std::get<SharedBytes>(std::move(file));
      bytes = beside.bytes;
      start = 0;
      if (beside_.insert(name).second) readable_ += bytes.size();
    }
    const std::uint64_t offset = rad_number(range, "offset"), length = rad_number(range, "bytes");
    if (start > bytes.size() || offset > bytes.size() - start || length > bytes.size() - start - offset)
      return "its end is missing";
    // Without this limit, overlapping chunks in a short file could cost unlimited time.
    if (length > readable_) return "its chunks overlap";
    readable_ -= length;
    bytes = bytes.subspan(start + static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
    const auto head = read_rad_head(bytes, kRadChunkMagic);
    if (!head || bytes.size() - head->end < 8) return "a chunk is damaged";
    return read_splats(head->meta, bytes.subspan(head->end + 8), model);
  }

  RadProblem read_splats(const RadJson& meta, std::span<const std::byte> payload, SplatModel& model) {
    const std::uint64_t count = rad_number(meta, "count");
    const auto properties = meta.find("properties");
    if (count == 0 || count > kMostRadSplats || rad_number(meta, "base") != model.size() || properties == meta.end() ||
        !properties->is_array() || properties->size() > kMostRadProperties)
      return "a chunk is damaged";
    if (count > payload.size() * kMostInflation / kLeastCenterBytes)
      return "a chunk of " + std::to_string(payload.size()) + " bytes announces " + std::to_string(count) + " splats";
    unread_ = payload.size();
    if (auto problem = model.draw(source_.budget, count)) return problem;
    const std::size_t first = model.size(), end = first + static_cast<std::size_t>(count);
    model.resize(end);
    children_.resize(end, 0);
    starts_.resize(end, 0);
    for (std::size_t i = first; i < end; ++i) model.rotations[i] = {0, 0, 0, 1};
    labels_.clear();
    for (const RadJson& property : *properties)
      if (auto problem = read_property(property, payload, first, end - first, model)) {
        model.resize(first);
        children_.resize(first);
        starts_.resize(first);
        return problem;
      }
    for (std::size_t i = 0; i < labels_.size(); ++i) put_codes(labels_[i], first + i, model);
    return std::nullopt;
  }

  /// Decompresses a property to at most `most` bytes. Returns a message if it is damaged.
  std::variant<std::vector<std::byte>, std::string> unpacked(const RadJson& property,
                                                             std::span<const std::byte> payload, std::size_t most) {
    const std::uint64_t offset = rad_number(property, "offset"), length = rad_number(property, "bytes");
    if (offset > payload.size() || length > payload.size() - offset || length > std::numeric_limits<uInt>::max())
      return std::string("a property is damaged");
    if (length > unread_) return std::string("the properties of a chunk overlap");
    unread_ -= length;
    const auto packed = payload.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
    most = static_cast<std::size_t>(std::min<std::uint64_t>(most, (length + 1) * kMostInflation));
    if (!share_.grow(most)) return "RAD needs " + source_.budget->refusal(Resource::files);
    const std::string compression = rad_text(property, "compression");
    if (compression.empty()) return std::vector<std::byte>(packed.begin(), packed.end());
    if (compression != "gz") return "its compression " + compression.substr(0, 20) + " is not known; expected gz";
    std::vector<std::byte> result(most);
    z_stream stream{};
    if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) return std::string("zlib cannot be initialised");
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(packed.data()));
    stream.avail_in = static_cast<uInt>(packed.size());
    stream.next_out = reinterpret_cast<Bytef*>(result.data());
    stream.avail_out = static_cast<uInt>(result.size());
    (void)inflate(&stream, Z_FINISH);
    result.resize(result.size() - stream.avail_out);
    inflateEnd(&stream);
    return result;
  }

  RadProblem read_property(const RadJson& property, std::span<const std::byte> payload, std::size_t first,
                           std::size_t count, SplatModel& model) {
    if (!property.is_object()) return "a property is damaged";
    const std::string name = rad_text(property, "property"), encoding = rad_text(property, "encoding");
    const std::size_t width = RadPlanes::width_of(encoding);
    std::size_t dimensions = name == "alpha" || name.starts_with("child_") || name == "sh_label" ? 1 : 3;
    const int degree = name.starts_with("sh") && name != "sh_label" && name.size() > 2 ? name[2] - '0' : 0;
    if (degree < 0 || degree > 3) return std::nullopt;  // of a later version
    if (degree > 0) dimensions = 3 * static_cast<std::size_t>(2 * degree + 1);
    if (width == 0) return "its encoding " + encoding.substr(0, 20) + " of " + name.substr(0, 20) + " is not known";
    const bool codes = name.ends_with("_code");
    const std::size_t splats = codes ? kMostRadCodes : count, most = splats * dimensions * width;
    if (most > (std::size_t{1} << 31)) return "a chunk is too large";
    share_ = Share(source_.budget, Resource::files);
    auto result = unpacked(property, payload, codes ? std::min(most, std::size_t{1} << 27) : most);
    if (auto* problem = std::get_if<std::string>(&result)) return std::move(*problem);
    const auto& data = std::get<std::vector<std::byte>>(result);
    if (!codes && data.size() < most) return name.substr(0, 20) + " of a chunk is damaged";
    const RadPlanes planes(property, data);
    if (codes) {
      const std::size_t entries = data.size() / (dimensions * width);
      auto& to = codes_[static_cast<std::size_t>(degree)];
      to.assign(entries * dimensions, 0);
      planes.for_each(dimensions, entries, [&](std::size_t i, std::size_t k, float v) { to[i * dimensions + k] = v; });
      code_shares_[static_cast<std::size_t>(degree)] = Share(source_.budget, Resource::files);
      if (!code_shares_[static_cast<std::size_t>(degree)].grow(4 * to.size()))
        return "RAD needs " + source_.budget->refusal(Resource::files);
      return std::nullopt;
    }
    put_property(name, degree, planes, dimensions, data, first, count, model);
    return std::nullopt;
  }

  void put_property(const std::string& name, int degree, const RadPlanes& planes, std::size_t dimensions,
                    std::span<const std::byte> data, std::size_t first, std::size_t count, SplatModel& model) {
    const auto put = [&](const auto& use) { planes.for_each(dimensions, count, use); };
    if (name == "center")
      put([&](std::size_t i, std::size_t k, float v) { model.positions[first + i][static_cast<int>(k)] = double{v}; });
    if (name == "alpha")
      put([&](std::size_t i, std::size_t, float v) { model.opacities[first + i] = std::min(v, 1.0f); });
    if (name == "rgb")
      put([&](std::size_t i, std::size_t k, float v) {
        model.dc[first + i][static_cast<int>(k)] = (v - 0.5f) / kSphericalHarmonic0;
      });
    if (name == "scales")
      put([&](std::size_t i, std::size_t k, float v) { model.scales[first + i][static_cast<int>(k)] = v; });
    if (name == "orientation" && data.size() == 3 * count)  // three bytes per splat
      for (std::size_t i = 0; i < count; ++i) model.rotations[first + i] = rotation_of_oct88r8(data.data() + 3 * i);
    else if (name == "orientation")
      put([&](std::size_t i, std::size_t k, float v) {
        glm::vec4& q = model.rotations[first + i];
        q[static_cast<int>(k)] = v;
        if (k == 2) q.w = std::sqrt(std::max(0.0f, 1 - q.x * q.x - q.y * q.y - q.z * q.z));
      });
    if (degree > 0 && degree <= model.degree)
      put([&](std::size_t i, std::size_t k, float v) { coefficient(model, first + i, degree, k) = v; });
    if (name == "child_count" && data.size() >= 2 * count)
      for (std::size_t i = 0; i < count; ++i) children_[first + i] = load_little<std::uint16_t>(data.data() + 2 * i);
    if (name == "child_start" && data.size() >= 4 * count)
      for (std::size_t i = 0; i < count; ++i) starts_[first + i] = load_little<std::uint32_t>(data.data() + 4 * i);
    if (const std::size_t width = data.size() / count; name == "sh_label" && width >= 2) {
      labels_.resize(count);
      for (std::size_t i = 0; i < count; ++i)
        labels_[i] = width >= 4 ? load_little<std::uint32_t>(data.data() + 4 * i)
                                : load_little<std::uint16_t>(data.data() + 2 * i);
    }
  }

  /// Returns number `k` of the harmonics of a degree, stored as red, green and blue of each coefficient.
  static float& coefficient(SplatModel& model, std::size_t splat, int degree, std::size_t k) {
    const std::size_t before = qnv::harmonic_count(degree - 1);
    return model.coefficient(splat, before + k / 3)[static_cast<int>(k % 3)];
  }

  void put_codes(std::uint32_t label, std::size_t splat, SplatModel& model) {
    for (int degree = 1; degree <= model.degree; ++degree) {
      const auto& codes = codes_[static_cast<std::size_t>(degree)];
      const std::size_t dimensions = 3 * static_cast<std::size_t>(2 * degree + 1);
      if ((label + std::size_t{1}) * dimensions > codes.size()) continue;
      for (std::size_t k = 0; k < dimensions; ++k) coefficient(model, splat, degree, k) = codes[label * dimensions + k];
    }
  }

  /// Keeps the splats without children, and the splats with children that were not read.
  void keep_finest(SplatModel& model) const {
    const std::size_t per = qnv::harmonic_count(model.degree);
    std::size_t to = 0;
    for (std::size_t i = 0; i < model.size(); ++i) {
      if (children_[i] > 0 && starts_[i] > i && std::uint64_t{starts_[i]} + children_[i] <= model.size()) continue;
      model.positions[to] = model.positions[i];
      model.scales[to] = model.scales[i];
      model.rotations[to] = model.rotations[i];
      model.opacities[to] = model.opacities[i];
      model.dc[to] = model.dc[i];
      for (std::size_t k = 0; k < per; ++k) model.coefficients[to * per + k] = model.coefficients[i * per + k];
      ++to;
    }
    model.resize(to);
    model.announced = to;
  }

  const ImportSource& source_;
  std::uint64_t readable_;                   // bytes of all files that no chunk has used
  std::uint64_t unread_ = 0;                 // bytes of the chunk that no property has used
  std::set<std::string> beside_;             // files with chunks that were read
  std::vector<std::uint16_t> children_;      // number of children of each node
  std::vector<std::uint32_t> starts_;        // index of the first child of each node
  std::vector<std::uint32_t> labels_;        // palette entry of each splat of a chunk
  std::array<std::vector<float>, 4> codes_;  // palettes of harmonics, by degree
  std::array<Share, 4> code_shares_;
  Share share_;
};

}  // namespace

bool is_splats_rad(std::span<const std::byte> bytes) {
  return bytes.size() >= 8 && load_little<std::uint32_t>(bytes.data()) == kRadMagic;
}

Asset read_splats_rad(const ImportSource& source) {
  SplatModel model;
  auto problem = RadReader(source).read(model);
  ImportedVectors imported = problem ? ImportedVectors("RAD: " + *problem) : import_result(model);
  if (auto* splats = std::get_if<qnv::Splats>(&imported)) return std::move(*splats);
  if (auto* splats = std::get_if<qnv::Gaussians>(&imported)) return std::move(*splats);
  source.diagnostics.add({Severity::error, source.path, {}, std::get<std::string>(imported)});
  return {};
}

}  // namespace gs::app
