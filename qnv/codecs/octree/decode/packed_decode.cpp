#include "qnv/codecs/octree/decode/divide_cluster.h"
#include "qnv/codecs/octree/decode/packed_kernels.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace gs::qnv {
namespace {

bool take_bit(RansDecoder& rans, std::size_t lane, std::uint32_t probability) {
  const bool bit = rans.peek(lane) < probability;
  rans.advance(lane, bit ? 0 : probability, bit ? probability : kRansTotal - probability);
  return bit;
}

/// Decoder of one level of one cluster.
class LevelDecoder {
 public:
  LevelDecoder(RansDecoder& rans, const ClusterParameters& parameters, const PackedKernels& kernels,
               const PackedVoxels& from, std::size_t first, std::size_t count)
      : rans_(rans), p_(parameters), kernels_(kernels), from_(from), first_(first), count_(count) {}

  bool run(PackedVoxels& out, std::size_t most) {
    std::vector<std::uint8_t> masks(count_);
    std::array<std::uint32_t, kOccupancyBins> probabilities{};
    for (std::size_t i = 0; i < kOccupancyBins; ++i) probabilities[i] = occupancy_models()[p_.occupancy][i];
    kernels_.occupancy(rans_, probabilities.data(), from_, first_, count_, masks.data());
    for (const std::uint8_t mask : masks) {
      if (mask == 0) return false;  // rejects a divided voxel without children, which would vanish
      size_ += static_cast<std::size_t>(std::popcount(static_cast<unsigned>(mask)));
    }
    if (size_ > most) return false;
    out.resize(size_ + kKernelSlack, p_.colored);
    context_.resize(size_ + kKernelSlack);
    parent_.resize(size_ + kKernelSlack);
    residual_.resize(size_ + kKernelSlack);
    inherit(masks, out);
    if (p_.doubles) doubles(masks, out);
    normals(out);
    offsets(out);
    if (p_.colored) colors(out);
    out.resize(size_, p_.colored);
    return true;
  }

 private:
  void inherit(std::span<const std::uint8_t> masks, PackedVoxels& out) {
    PackedKernels::Inherited to{out.x.data(), out.y.data(),      out.z.data(),    out.u.data(),
                                out.v.data(), out.offset.data(), context_.data(), parent_.data()};
    if (!p_.normals_around && !p_.offsets_around) {
      kernels_.inherit(from_, first_, count_, masks.data(), to);
      return;
    }
    PlaneBlocks& blocks = plane_blocks();
    for (std::size_t done = 0; done < count_;) {
      const std::size_t n = blocks.fill(from_, first_ + done, count_ - done);
      const auto run = masks.subspan(done, n);
      kernels_.inherit_around(from_, first_ + done, n, run.data(), blocks.block(), p_.normals_around, p_.offsets_around,
                              to);
      std::size_t children = 0;
      for (const std::uint8_t mask : run)
        children += static_cast<std::size_t>(std::popcount(static_cast<unsigned>(mask)));
      to = {to.x + children, to.y + children,      to.z + children,       to.u + children,
            to.v + children, to.offset + children, to.context + children, to.parent + children};
      done += n;
    }
  }

  void doubles(const std::vector<std::uint8_t>& masks, PackedVoxels& out) {
    for (std::size_t i = 0; i < size_; ++i)
      if (take_bit(rans_, i % kRansLanes, kDoubleProbability)) out.state[i] = kDouble;
    std::size_t i = 0;
    for (const std::uint8_t mask : masks)
      for (unsigned c = 0; c < 8; ++c) {
        if ((mask >> c & 1) == 0) continue;
        const bool split = (from_.state[parent_[i]] & kDouble) != 0 && out.state[i] == 0;
        if (split && take_bit(rans_, i % kRansLanes, kRansTotal / 2)) flip(i, c, out);
        ++i;
      }
  }

  // Predicts a child on the opposite side of a thin sheet.
  void flip(std::size_t i, unsigned c, PackedVoxels& out) const {
    int u = from_.u[parent_[i]], v = from_.v[parent_[i]];
    flip_octahedral(u, v);
    out.u[i] = static_cast<std::int16_t>(u);
    out.v[i] = static_cast<std::int16_t>(v);
    out.offset[i] =
        static_cast<std::int8_t>(predicted_offset(along(octahedral_normal(u, v), c), -from_.offset[parent_[i]]));
  }

  void read(const std::array<std::uint8_t, kResidualContexts>& chosen) {
    const std::array<std::uint32_t, kResidualContexts> models{chosen[0], chosen[1], chosen[2]};
    kernels_.residuals(rans_, models.data(), context_.data(), size_, residual_.data());
  }

  void normals(PackedVoxels& out) {
    read(p_.normal);
    std::vector<std::int16_t> du(residual_.size());
    std::swap(du, residual_);
    read(p_.normal);
    kernels_.turn(out.u.data(), out.v.data(), out.state.data(), du.data(), residual_.data(), 1 << p_.normal_shift,
                  size_);
  }

  void offsets(PackedVoxels& out) {
    read(p_.offset);
    kernels_.move(out.offset.data(), residual_.data(), 1 << p_.offset_shift, size_);
  }

  void channel(const std::vector<std::int16_t>& from, std::vector<std::int16_t>& to, std::uint8_t chosen, int shift) {
    read({chosen, chosen, chosen});
    for (std::size_t i = 0; i < size_; ++i)
      to[i] = static_cast<std::int16_t>(std::clamp(from[parent_[i]] + residual_[i] * (1 << shift), -1024, 1024));
  }

  void colors(PackedVoxels& out) {
    channel(from_.luma, out.luma, p_.luma, p_.color_shift);
    channel(from_.co, out.co, p_.chroma, p_.color_shift + 1);
    channel(from_.cg, out.cg, p_.chroma, p_.color_shift + 1);
  }

  RansDecoder& rans_;
  const ClusterParameters& p_;
  const PackedKernels& kernels_;
  const PackedVoxels& from_;
  std::size_t first_, count_, size_ = 0;
  std::vector<std::uint8_t> context_;
  std::vector<std::uint16_t> parent_;
  std::vector<std::int16_t> residual_;
};

}  // namespace

std::variant<Cluster, PackedError> decode_cluster(std::span<const std::byte> payload, const Cluster* parent,
                                                  const PackedKernels& kernels) {
  auto read = read_cluster_header(payload);
  if (auto* error = std::get_if<PackedError>(&read)) return std::move(*error);
  Cluster cluster;
  cluster.header = std::get<ClusterHeader>(read);
  const ClusterHeader& header = cluster.header;
  const ClusterParameters parameters = read_parameters(payload);
  if (header.parent != kNoParent && parent && parameters.colored && parent->voxels.luma.empty())
    return PackedError{"a coloured cluster under one without colours"};
  auto problem = divide_cluster(
      payload, kClusterHeaderSize, parent, root_voxel(parameters.colored), cluster,
      [&](RansDecoder& rans, const PackedVoxels& from, std::size_t first, std::size_t count, int, PackedVoxels& next,
          std::size_t most) { return LevelDecoder(rans, parameters, kernels, from, first, count).run(next, most); });
  if (problem) return std::move(*problem);
  return cluster;
}

std::variant<Cluster, PackedError> decode_cluster(std::span<const std::byte> payload, const Cluster* parent) {
  return decode_cluster(payload, parent, packed_kernels());
}

std::uint32_t discs_of(const PackedVoxels& voxels, std::size_t first, std::size_t count) {
  auto discs = static_cast<std::uint32_t>(count);
  for (std::size_t i = first; i < first + count; ++i) discs += (voxels.state[i] & kDouble) != 0 ? 1 : 0;
  return discs;
}

void append_discs(const Cluster& cluster, std::size_t first, std::size_t count, const Cube& cube, Splats& splats) {
  const PackedVoxels& voxels = cluster.voxels;
  const float edge = cube.edge / static_cast<float>(1 << cluster.level());
  const bool colored = !voxels.luma.empty();
  if (colored) splats.colors.resize(splats.positions.size(), splats.color);
  for (std::size_t i = first; i < first + count; ++i) {
    const auto m = octahedral_normal(voxels.u[i], voxels.v[i]);
    const glm::vec3 l1 =
        glm::vec3(static_cast<float>(m[0]), static_cast<float>(m[1]), static_cast<float>(m[2])) * (1.0f / kOctahedral);
    const float length = std::sqrt(glm::dot(l1, l1));
    const glm::vec3 normal = l1 / length;
    const float offset = static_cast<float>(voxels.offset[i]) * (1.0f / kOffsetUnits);
    const glm::vec3 cell(static_cast<float>(voxels.x[i]) + 0.5f, static_cast<float>(voxels.y[i]) + 0.5f,
                         static_cast<float>(voxels.z[i]) + 0.5f);
    const glm::vec3 position = cube.lower + (cell + normal * (offset / length)) * edge;
    // Keeps the area positive and finite for a cube of any size.
    const float area = std::clamp(plane_section(l1, offset) * edge * edge, std::numeric_limits<float>::min(),
                                  std::numeric_limits<float>::max());
    Rgb8 color = splats.color;
    if (colored) {
      const auto rgb = rgb_of(voxels.luma[i], voxels.co[i], voxels.cg[i]);
      const auto component = [](int c) { return static_cast<std::uint8_t>(std::clamp(c, 0, 255)); };
      color = {component(rgb[0]), component(rgb[1]), component(rgb[2])};
    }
    for (int side = (voxels.state[i] & kDouble) != 0 ? 0 : 1; side < 2; ++side) {
      splats.positions.push_back(position);
      splats.normals.push_back(side == 1 ? normal : -normal);
      splats.weights.push_back(area);
      splats.cells.push_back({edge, (side == 1 ? offset : -offset) / length * edge});
      if (!splats.colors.empty() || colored) splats.colors.push_back(color);
    }
  }
}

}  // namespace gs::qnv
