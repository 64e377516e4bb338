#include "qnv/codecs/displaced/base_mesh.h"

#include "qnv/codecs/displaced/patches.h"
#include "qnv/entropy/binary_coder.h"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <deque>
#include <unordered_map>
#include <utility>

namespace gs::qnv::displaced {
namespace {

// The mesh grows triangle by triangle over open edges. All open edges at one vertex are filled before the next vertex.
// After C. Touma, C. Gotsman, Triangle mesh compression, 1998; S. Gumhold, W. Strasser, Real time compression of
// triangle mesh connectivity, 1998. FORMAT.md, "Base mesh", defines the order of decisions.

enum class Beside : std::uint8_t { fresh, left, right, rim, far };

/// Gate: side of a triangle from vertex a to vertex b that still lacks a triangle on its other side.
struct Gate {
  std::uint32_t a = 0, b = 0, opposite = 0;
};

/// Decision about the triangle beyond a gate.
struct Step {
  Beside beside = Beside::rim;
  std::uint32_t vertex = 0;  // index of the vertex, if `beside` is `far`
};

// Maximum number of triangles per byte of an encoded base mesh. Encoders add zero bytes if needed.
constexpr std::size_t kMaxTrianglesAByte = 64;
// Maximum number of gates that start at a vertex, and that end there. Real meshes have two or three.
constexpr std::size_t kMaxGates = 64;

std::uint64_t key(std::uint32_t a, std::uint32_t b) { return std::uint64_t{a} << 32 | b; }

/// Model of a signed number. The bit length is adaptive; the sign and the low bits are plain.
struct OffsetModel {
  std::array<BitModel, 20> more;
};

class BaseModels {
 public:
  std::array<BitModel, 8> fresh, right, left, rim;
  std::array<OffsetModel, 2> offsets;  // [0]: for vertices at a gate; [1]: for a component's first triangle
  BitModel component;
  std::array<BitModel, 4> crease;
};

/// Decoder of the decisions.
class BaseReader {
 public:
  BaseReader(std::span<const std::byte> bytes, int bits) : decoder_(bytes), bits_(bits) {}
  bool component() { return decoder_.get(models_.component); }
  Step step(std::size_t a, std::size_t b, bool has_left, bool has_right, std::uint32_t vertices) {
    if (decoder_.get(models_.fresh[b])) return {Beside::fresh};
    if (has_right && decoder_.get(models_.right[b])) return {Beside::right};
    if (has_left && decoder_.get(models_.left[a])) return {Beside::left};
    if (decoder_.get(models_.rim[0])) return {Beside::rim};
    const int bits = std::bit_width(vertices);
    return {Beside::far, decoder_.get_bits(bits)};
  }
  glm::ivec3 place(const glm::ivec3& predicted, std::size_t kind) {
    glm::ivec3 p = predicted;
    for (int axis = 0; axis < 3; ++axis) p[axis] += offset(models_.offsets[kind]);
    return p;
  }
  bool crease(std::size_t context, std::uint32_t, std::uint32_t) { return decoder_.get(models_.crease[context]); }
  [[nodiscard]] int bits() const { return bits_; }
  [[nodiscard]] bool exhausted() const { return decoder_.exhausted(); }

 private:
  int offset(OffsetModel& model) {
    int bits = 0;
    while (bits < 19 && decoder_.get(model.more[static_cast<std::size_t>(bits)])) ++bits;
    if (bits == 0) return 0;
    const bool negative = decoder_.get_bits(1) != 0;
    const int size = 1 << (bits - 1) | static_cast<int>(decoder_.get_bits(bits - 1));
    return negative ? -size : size;
  }
  BinaryDecoder decoder_;
  BaseModels models_;
  int bits_;
};

/// Encoder of the decisions, which it derives from the mesh.
class BaseWriter {
 public:
  BaseWriter(const BaseMesh& mesh, const std::function<bool(std::uint32_t, std::uint32_t)>& is_crease)
      : mesh_(mesh), is_crease_(is_crease), coded_(mesh.vertices.size(), kNone), done_(mesh.triangles.size(), false) {
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) sides_.emplace(key(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]), t);
  }
  bool component() {
    while (next_ < done_.size() && done_[next_]) ++next_;
    const bool another = next_ < done_.size();
    encoder_.put(models_.component, another);
    if (another) {
      done_[next_] = true;
      coming_.assign(mesh_.triangles[next_].begin(), mesh_.triangles[next_].end());
    }
    return another;
  }
  Step step(std::size_t a, std::size_t b, bool has_left, bool has_right, std::uint32_t vertices) {
    // Uses the vertices that the last beyond() stored.
    const bool fresh = third_ != kNone && coded_[third_] == kNone;
    encoder_.put(models_.fresh[b], fresh);
    if (fresh) {
      coming_.push_back(third_);
      return {Beside::fresh};
    }
    const std::uint32_t v = third_ == kNone ? kNone : coded_[third_];
    if (has_right) {
      encoder_.put(models_.right[b], v == right_);
      if (v == right_) return {Beside::right};
    }
    if (has_left) {
      encoder_.put(models_.left[a], v == left_);
      if (v == left_) return {Beside::left};
    }
    encoder_.put(models_.rim[0], v == kNone);
    if (v == kNone) return {Beside::rim};
    encoder_.put_bits(v, std::bit_width(vertices));
    return {Beside::far, v};
  }
  /// Selects the mesh's triangle at the side from b to a, for the next step().
  void beyond(std::uint32_t a, std::uint32_t b, std::uint32_t left, std::uint32_t right) {
    left_ = left;
    right_ = right;
    third_ = kNone;
    const auto found = sides_.find(key(source[b], source[a]));
    if (found == sides_.end()) return;
    done_[found->second] = true;
    for (const std::uint32_t v : mesh_.triangles[found->second])
      if (v != source[a] && v != source[b]) third_ = v;
  }
  glm::ivec3 place(const glm::ivec3& predicted, std::size_t kind) {
    const std::uint32_t v = coming_.front();
    coming_.pop_front();
    coded_[v] = static_cast<std::uint32_t>(source.size());
    source.push_back(v);
    const glm::ivec3 p = mesh_.vertices[v];
    for (int axis = 0; axis < 3; ++axis) offset(models_.offsets[kind], p[axis] - predicted[axis]);
    return p;
  }
  bool crease(std::size_t context, std::uint32_t a, std::uint32_t b) {
    const bool is = is_crease_(source[a], source[b]);
    encoder_.put(models_.crease[context], is);
    return is;
  }
  [[nodiscard]] int bits() const { return mesh_.bits; }
  [[nodiscard]] static bool exhausted() { return false; }
  std::vector<std::byte> finish() { return encoder_.finish(); }

  std::vector<std::uint32_t> source;

 private:
  void offset(OffsetModel& model, int value) {
    const auto size = static_cast<std::uint32_t>(std::abs(value));
    const int bits = std::bit_width(size);
    for (int i = 0; i < bits; ++i) encoder_.put(model.more[static_cast<std::size_t>(i)], true);
    if (bits < 19) encoder_.put(model.more[static_cast<std::size_t>(bits)], false);
    if (bits == 0) return;
    encoder_.put_bits(value < 0 ? 1 : 0, 1);
    encoder_.put_bits(size & ((1u << (bits - 1)) - 1), bits - 1);
  }
  const BaseMesh& mesh_;
  const std::function<bool(std::uint32_t, std::uint32_t)>& is_crease_;
  BinaryEncoder encoder_;
  BaseModels models_;
  std::vector<std::uint32_t> coded_;
  std::vector<bool> done_;
  std::unordered_map<std::uint64_t, std::uint32_t> sides_;
  std::deque<std::uint32_t> coming_;
  std::size_t next_ = 0;
  std::uint32_t third_ = kNone, left_ = kNone, right_ = kNone;
};

/// Open gates, indexed by their end vertices. At each vertex, the newest gate is used first.
class Gates {
 public:
  /// Opens a gate. Returns false if a vertex then has more than kMaxGates gates.
  bool open(const Gate& gate) {
    by_start_[gate.a].push_back(gate);
    by_end_[gate.b].push_back(gate);
    return by_start_[gate.a].size() <= kMaxGates && by_end_[gate.b].size() <= kMaxGates;
  }
  void close(std::uint32_t a, std::uint32_t b) {
    drop(by_start_[a], a, b);
    drop(by_end_[b], a, b);
  }
  [[nodiscard]] const Gate* from(std::uint32_t v) const {
    return by_start_[v].empty() ? nullptr : &by_start_[v].back();
  }
  [[nodiscard]] const Gate* to(std::uint32_t v) const { return by_end_[v].empty() ? nullptr : &by_end_[v].back(); }
  [[nodiscard]] bool is_open(std::uint32_t a, std::uint32_t b) const {
    return std::any_of(by_start_[a].begin(), by_start_[a].end(), [&](const Gate& g) { return g.b == b; });
  }
  void add_vertex() {
    by_start_.emplace_back();
    by_end_.emplace_back();
  }

 private:
  static void drop(std::vector<Gate>& gates, std::uint32_t a, std::uint32_t b) {
    std::erase_if(gates, [&](const Gate& g) { return g.a == a && g.b == b; });
  }
  std::vector<std::vector<Gate>> by_start_, by_end_;
};

/// Grows a mesh from the decisions of a BaseReader or a BaseWriter. Returns false if the decisions do not describe a
/// base mesh.
template <class Decisions>
bool grow(Decisions& decisions, std::size_t most_triangles, BaseMesh& mesh) {
  Gates gates;
  std::unordered_map<std::uint64_t, bool> sides;  // sides of all triangles
  std::vector<std::size_t> around;                // number of triangles at each vertex
  const int top = (1 << decisions.bits()) - 1;
  mesh.bits = decisions.bits();
  const auto add_vertex = [&](const glm::ivec3& predicted, std::size_t kind) {
    const glm::ivec3 p = decisions.place(glm::clamp(predicted, glm::ivec3(0), glm::ivec3(top)), kind);
    mesh.vertices.push_back(p);
    gates.add_vertex();
    around.push_back(0);
    return p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x <= top && p.y <= top && p.z <= top;
  };
  const auto add_triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (a == b || b == c || c == a || mesh.triangles.size() >= most_triangles) return false;
    const Corners corners{a, b, c};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t u = corners[k], v = corners[(k + 1) % 3];
      if (!sides.emplace(key(u, v), true).second) return false;
      ++around[u];
      if (gates.is_open(v, u))
        gates.close(v, u);
      else if (!sides.contains(key(v, u)) && !gates.open({u, v, corners[(k + 2) % 3]}))
        return false;
    }
    mesh.triangles.push_back(corners);
    return true;
  };
  const auto context = [&](std::uint32_t v) { return std::min<std::size_t>(around[v], 7); };
  glm::ivec3 last((top + 1) / 2);
  for (std::uint32_t pivot = 0; decisions.component();) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::size_t k = 0; k < 3; ++k) {
      if (!add_vertex(last, 1)) return false;
      last = mesh.vertices.back();
    }
    if (!add_triangle(first, first + 1, first + 2) || decisions.exhausted()) return false;
    for (pivot = first; pivot < mesh.vertices.size(); ++pivot)
      while (const Gate* open = gates.to(pivot)) {
        const Gate gate = *open;
        const Gate* left = gates.to(gate.a);
        const Gate* right = gates.from(gate.b);
        const std::uint32_t left_vertex = left ? left->a : kNone, right_vertex = right ? right->b : kNone;
        // If the left and the right neighbour are the same vertex, codes the decision as "right".
        const bool has_left = left && left_vertex != right_vertex;
        if constexpr (requires { decisions.beyond(0u, 0u, 0u, 0u); })
          decisions.beyond(gate.a, gate.b, left_vertex, right_vertex);
        const Step step = decisions.step(context(gate.a), context(gate.b), has_left, right != nullptr,
                                         static_cast<std::uint32_t>(mesh.vertices.size()));
        std::uint32_t vertex = step.vertex;
        if (decisions.exhausted()) return false;
        if (step.beside == Beside::rim) {
          gates.close(gate.a, gate.b);
          continue;
        }
        if (step.beside == Beside::left) vertex = left_vertex;
        if (step.beside == Beside::right) vertex = right_vertex;
        if (step.beside == Beside::fresh) {
          vertex = static_cast<std::uint32_t>(mesh.vertices.size());
          const glm::ivec3 a = mesh.vertices[gate.a], b = mesh.vertices[gate.b], o = mesh.vertices[gate.opposite];
          if (!add_vertex(a + b - o, 0)) return false;
        }
        if (vertex >= mesh.vertices.size() || !add_triangle(gate.b, gate.a, vertex)) return false;
      }
  }
  // Creases usually continue at the end of another crease.
  const Patches patches(mesh.triangles, static_cast<std::uint32_t>(mesh.vertices.size()));
  std::vector<std::uint8_t> meet(mesh.vertices.size(), 0);
  mesh.creases.assign(patches.edges().size(), false);
  bool any = false;
  for (std::size_t e = 0; e < patches.edges().size(); ++e) {
    const Patches::Edge& edge = patches.edges()[e];
    if (edge.other == kNone) continue;
    const auto touches = [&](std::uint32_t v) { return meet[v] != 0 ? std::size_t{1} : std::size_t{0}; };
    const bool crease = decisions.crease(touches(edge.from) + touches(edge.to), edge.from, edge.to);
    mesh.creases[e] = crease;
    any = any || crease;
    if (crease) meet[edge.from] = meet[edge.to] = 1;
  }
  if (!any) mesh.creases.clear();
  return !decisions.exhausted();
}

}  // namespace

CodedBase encode_base(const BaseMesh& mesh, const std::function<bool(std::uint32_t, std::uint32_t)>& is_crease) {
  CodedBase coded;
  BaseWriter writer(mesh, is_crease);
  (void)grow(writer, mesh.triangles.size(), coded.mesh);
  coded.source = std::move(writer.source);
  coded.bytes = writer.finish();
  coded.bytes.insert(coded.bytes.begin(), static_cast<std::byte>(mesh.bits));
  const std::size_t least = (mesh.triangles.size() + kMaxTrianglesAByte - 1) / kMaxTrianglesAByte;
  if (coded.bytes.size() < least) coded.bytes.resize(least);
  return coded;
}

std::optional<BaseMesh> decode_base(std::span<const std::byte> bytes, std::size_t most_triangles) {
  if (bytes.empty()) return {};
  const int bits = std::to_integer<int>(bytes[0]);
  if (bits < 1 || bits > 16) return {};
  BaseReader reader(bytes.subspan(1), bits);
  BaseMesh mesh;
  if (!grow(reader, std::min(most_triangles, kMaxTrianglesAByte * bytes.size()), mesh)) return {};
  return mesh;
}

}  // namespace gs::qnv::displaced
