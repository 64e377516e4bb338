#pragma once

#include "qnv/container.h"
#include "qnv/packed.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Some discs of a cloud.
struct Piece {
  std::shared_ptr<const Cloud> cloud;
  std::size_t first = 0, count = 0;
};

/// From where, and how closely, a stream is looked at. Node space: the units of the stream.
struct LodView {
  glm::vec3 eye{0};
  float pixels = 1000;                // of one unit at distance one
  std::array<glm::vec4, 5> planes{};  // inside of the view: dot(plane, (p, 1)) >= 0; all zero: everything is
  std::size_t budget = 0;             // discs at most; 0: no limit
  float error_pixels = 1;             // voxels need not be smaller than this on the screen
};

/// A packed stream that lies in memory as it came, of which a view decodes what it needs: the coarse
/// clusters everywhere, finer ones where they are seen, the largest on the screen first. One thread.
class LodStream {
 public:
  /// `cache_discs`: how many decoded discs are kept at most, beside those of the
  /// last cut. The error says why the stream cannot be read so. Safe for untrusted bytes.
  static std::variant<std::unique_ptr<LodStream>, StreamProblem> open(std::vector<std::byte> bytes,
                                                                      std::size_t cache_discs = std::size_t{1} << 24);

  /// What to draw: covers everything in view once, without holes and without overlap. Clusters wholly outside of the
  /// view are left out.
  [[nodiscard]] std::vector<Piece> cut(const LodView& view);

  /// All vectors at full detail, copied together.
  [[nodiscard]] Cloud whole();

  [[nodiscard]] const StreamHeader& header() const { return header_; }
  /// What was wrong with the bytes; the stream is what is left.
  [[nodiscard]] const std::vector<StreamProblem>& problems() const { return problems_; }
  [[nodiscard]] std::size_t clusters() const { return nodes_.size(); }
  [[nodiscard]] std::size_t cached_discs() const { return cached_discs_; }

 private:
  struct Node {
    std::span<const std::byte> payload;
    ClusterHeader cluster;
    std::uint32_t parent = kNoParent;  // index in nodes_
    std::vector<std::uint32_t> children;
    Box box;
    std::uint32_t voxels = 0;
    // Filled while it is cached.
    std::unique_ptr<Cluster> decoded;
    std::shared_ptr<const Cloud> cloud;
    std::vector<std::uint32_t> first_disc;  // of every voxel, and one more
    std::uint64_t used = 0;                 // the cut that needed it last
    bool broken = false;
  };
  LodStream() = default;
  void scan();
  bool decode(std::uint32_t node);
  void pieces_of(std::uint32_t node, const std::vector<bool>& chosen, std::vector<Piece>& out) const;
  void forget_unused();

  std::vector<std::byte> bytes_;
  std::vector<StreamProblem> problems_;
  StreamHeader header_;
  std::vector<Node> nodes_;  // parents before children
  std::size_t cache_discs_ = 0, cached_discs_ = 0;
  std::uint64_t cuts_ = 0;
};

}  // namespace gs::qnv
