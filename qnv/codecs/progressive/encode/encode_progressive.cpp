#include "base/bytes.h"
#include "qnv/codecs/lossless/exact_tail.h"
#include "qnv/codecs/progressive/progressive.h"
#include "qnv/codecs/progressive/progressive_header.h"
#include "qnv/entropy/binary_coder.h"
#include "qnv/mesh/simplify/simplifier.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::qnv::progressive {
namespace {

using displaced::BinaryEncoder;
using displaced::HalfCollapse;
using displaced::Simplifier;
using displaced::SurfaceMesh;

// Maximum fraction of the vertices that a pass splits. A larger fraction would mix important and unimportant splits; a
// smaller one would need more bits to mark the splits.
constexpr double kPartOfPass = 0.12;
constexpr int kFirstBits = 9;
constexpr std::size_t kFirstSegmentBytes = 150, kSegmentBytes = 700, kMaxSegments = 65536;
// Triangles per byte of the front with which the search for the first mesh begins.
constexpr double kMaxTrianglesOfFront = 0.9;
// Maximum distance, in lattice steps, that splits move the surface when a pass of position bits begins to pay.
constexpr double kStepsOfSplits = 2;

/// Guide for an encoder: the action at each vertex, in the order of visits.
class SplitGuide {
 public:
  /// `numbers` has the index of each source vertex in the first mesh; kNone if a split adds it later.
  SplitGuide(const std::vector<glm::ivec3>& places, int finest, std::vector<std::uint32_t> numbers)
      : places_(places),
        finest_(finest),
        numbers_(std::move(numbers)),
        sources_(numbers_.size(), kNone),
        of_(numbers_.size(), nullptr) {
    for (std::uint32_t v = 0; v < numbers_.size(); ++v)
      if (numbers_[v] != kNone) sources_[numbers_[v]] = v;
  }
  /// Sets the next pass. `collapses` are the collapses that the pass undoes; if empty, the pass adds position bits.
  void pass(std::span<const HalfCollapse> collapses, int bits) {
    refines_ = collapses.empty();
    bits_ = bits;
    for (const HalfCollapse& c : collapses) of_[c.stays] = &c;
  }
  [[nodiscard]] bool refines() const { return refines_; }
  [[nodiscard]] bool low_bit(std::uint32_t vertex, int axis, int bits) const {
    return (places_[sources_[vertex]][axis] >> (finest_ - bits) & 1) != 0;
  }
  [[nodiscard]] std::optional<WantedSplit> split(std::uint32_t vertex, const VertexRing& ring) const {
    const HalfCollapse* c = of_[sources_[vertex]];
    if (!c) return {};
    WantedSplit wanted;
    wanted.place = places_[c->gone] >> (finest_ - bits_);
    const auto at = [&](std::uint32_t of) {
      return static_cast<std::uint32_t>(std::ranges::find(ring.neighbours, numbers_[of]) - ring.neighbours.begin());
    };
    wanted.how.left = c->left != kNone;
    wanted.how.right = c->right != kNone;
    wanted.how.first = wanted.how.left ? at(c->left) : 0;
    wanted.how.last = wanted.how.right ? at(c->right) : static_cast<std::uint32_t>(ring.corners.size());
    if (!ring.open && wanted.how.last <= wanted.how.first)
      wanted.how.last += static_cast<std::uint32_t>(ring.corners.size());
    return wanted;
  }
  void divided(std::uint32_t vertex, std::uint32_t made) {
    const HalfCollapse*& c = of_[sources_[vertex]];
    numbers_[c->gone] = made;
    sources_[made] = c->gone;
    c = nullptr;
  }

 private:
  const std::vector<glm::ivec3>& places_;
  int finest_, bits_ = 0;
  bool refines_ = false;
  std::vector<std::uint32_t> numbers_, sources_;  // index of each source vertex; source vertex of each index
  std::vector<const HalfCollapse*> of_;  // collapse to undo, for each source vertex
};

/// First mesh, encoded as the front of a stream.
struct FirstMesh {
  std::vector<std::byte> bytes;
  std::vector<std::uint32_t> numbers;  // index of each source vertex
};

FirstMesh first_of(const Simplifier& simplifier, const SurfaceMesh& source, const exact::ExactMesh& mesh, int bits) {
  std::vector<std::uint32_t> places;
  exact::ExactMesh coarse;
  coarse.bits = bits;
  coarse.crease_angle = mesh.crease_angle;
  coarse.triangles = simplifier.result(source, places).triangles;
  std::size_t count = 0;
  for (const std::uint32_t p : places) count += p != kNone ? 1 : 0;
  coarse.vertices.resize(count);
  for (std::size_t v = 0; v < places.size(); ++v)
    if (places[v] != kNone) coarse.vertices[places[v]] = mesh.vertices[v] >> (mesh.bits - bits);
  FirstMesh first;
  exact::TailOrder order;
  first.bytes = exact::encode_tail(coarse, true, nullptr, &order);
  first.numbers.assign(places.size(), kNone);
  for (std::size_t v = 0; v < places.size(); ++v)
    if (places[v] != kNone) first.numbers[v] = order.vertices[places[v]];
  return first;
}

/// Writer of segments. Each segment continues where the previous one ended.
class SegmentWriter {
 public:
  explicit SegmentWriter(SplitGrowth& growth, ProgressiveBytes& out) : growth_(growth), out_(out) {}
  bool pass(SplitGuide& guide) {
    do {
      exact::Decisions<BinaryEncoder> decisions(encoder_);
      if (!growth_.visit(decisions, guide)) return false;
      ++visits_;
      if (encoder_.size() >= aimed_) finish();
    } while (!growth_.between());
    return true;
  }
  void finish() {
    if (visits_ == 0) return;
    std::vector<std::byte>& payload = out_.segments.emplace_back();
    ByteWriter writer(payload);
    writer.integer(static_cast<std::uint16_t>(out_.segments.size() - 1));
    writer.integer(visits_);
    const std::vector<std::byte> body = std::exchange(encoder_, {}).finish();
    payload.insert(payload.end(), body.begin(), body.end());
    const std::size_t least = visits_ / kMaxVisitsAByte + 1;
    if (payload.size() < least) payload.resize(least);
    aimed_ = std::min(aimed_ * 5 / 4, kSegmentBytes);
    visits_ = 0;
  }

 private:
  SplitGrowth& growth_;
  ProgressiveBytes& out_;
  BinaryEncoder encoder_;
  std::size_t aimed_ = kFirstSegmentBytes;
  std::uint32_t visits_ = 0;
};

/// Coarsest mesh, and the passes of collapses that led to it.
struct CollapsedMesh {
  std::vector<std::vector<HalfCollapse>> passes;
  FirstMesh first;
  int bits = kFirstBits;
};

std::optional<CollapsedMesh> collapsed(const exact::ExactMesh& mesh, std::size_t most_first) {
  SurfaceMesh source;
  const float scale = std::ldexp(1.0f, -mesh.bits);
  source.positions.reserve(mesh.vertices.size());
  for (const glm::ivec3& p : mesh.vertices) source.positions.push_back(glm::vec3(p) * scale);
  source.triangles = mesh.triangles;
  Simplifier simplifier(source, {}, Simplifier::Way::halves);
  CollapsedMesh out;
  out.bits = std::min(kFirstBits, mesh.bits);
  std::size_t left = mesh.vertices.size();
  const double allowed = kMaxTrianglesOfFront * static_cast<double>(most_first);
  for (;;) {
    double most = kPartOfPass * static_cast<double>(left);
    const double over = static_cast<double>(simplifier.triangles()) - allowed;
    if (over <= 0) {
      out.first = first_of(simplifier, source, mesh, out.bits);
      const double part = static_cast<double>(most_first) / static_cast<double>(out.first.bytes.size());
      if (part >= 1) return out;
      most = std::min(most, 0.7 * (1 - part) * static_cast<double>(left) + 1);
    } else {
      most = std::min(most, over / 2 + 1);
    }
    const auto wanted = static_cast<std::size_t>(most) + 1;
    std::vector<HalfCollapse> pass = simplifier.collapse_apart(wanted);
    if (pass.empty()) {
      // If thin parts stop the simplification, allows that triangles flip.
      simplifier.turn_freely();
      pass = simplifier.collapse_apart(wanted);
    }
    if (pass.empty()) return {};
    left -= pass.size();
    out.passes.push_back(std::move(pass));
  }
}

/// Writes the segments. Returns false if the splits cannot be encoded.
bool write_segments(const exact::ExactMesh& mesh, const CollapsedMesh& coarse, bool middles, ProgressiveBytes& out) {
  auto first = exact::decode_tail(coarse.first.bytes, mesh.vertices.size());
  if (!first) return false;
  SplitGrowth growth(SplitMesh(std::move(*first)), coarse.bits, mesh.bits, mesh.vertices.size(), mesh.triangles.size(),
                     middles);
  SplitGuide guide(mesh.vertices, mesh.bits, coarse.first.numbers);
  SegmentWriter segments(growth, out);
  const auto refine_below = [&](double distance) {
    while (growth.bits() < mesh.bits && distance < kStepsOfSplits * std::ldexp(1.0, -growth.bits())) {
      guide.pass({}, growth.bits() + 1);
      if (!segments.pass(guide)) return false;
    }
    return true;
  };
  for (auto pass = coarse.passes.rbegin(); pass != coarse.passes.rend(); ++pass) {
    std::vector<double> distances;
    for (const HalfCollapse& c : *pass) distances.push_back(c.distance);
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::ranges::nth_element(distances, middle);
    if (!refine_below(*middle)) return false;
    guide.pass(*pass, growth.bits());
    if (!segments.pass(guide)) return false;
  }
  if (!refine_below(0)) return false;
  segments.finish();
  return out.segments.size() <= kMaxSegments;
}

}  // namespace

std::optional<ProgressiveBytes> encode_progressive(const exact::ExactMesh& mesh, std::size_t most_front) {
  if (!mesh.colors.empty() || most_front <= kFrontBytes) return {};
  const auto coarse = collapsed(mesh, most_front - kFrontBytes);
  if (!coarse) return {};
  std::optional<ProgressiveBytes> best;
  std::size_t least = 0;
  for (const bool middles : {false, true}) {
    ProgressiveBytes out;
    if (!write_segments(mesh, *coarse, middles, out)) return {};
    std::size_t bytes = 0;
    for (const auto& segment : out.segments) bytes += segment.size();
    if (best && bytes >= least) continue;
    least = bytes;
    ByteWriter writer(out.front);
    writer.integer(kFrontMark);
    writer.integer(static_cast<std::uint8_t>(mesh.bits));
    writer.integer(static_cast<std::uint8_t>(middles ? 1 : 0));
    writer.integer(static_cast<std::uint8_t>(mesh.shading.rule));
    writer.integer(static_cast<std::uint8_t>(mesh.shading.rule == exact::Shading::Rule::edges ? mesh.crease_angle
                                                                                              : mesh.shading.angle));
    writer.integer(static_cast<std::uint32_t>(mesh.vertices.size()));
    writer.integer(static_cast<std::uint32_t>(mesh.triangles.size()));
    out.front.insert(out.front.end(), coarse->first.bytes.begin(), coarse->first.bytes.end());
    out.vertices = mesh.vertices.size();
    best = std::move(out);
  }
  return best;
}

}  // namespace gs::qnv::progressive
