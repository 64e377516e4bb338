#include "app/formats/volume/confined/confined_volume.h"

#include "app/formats/volume/confined/confined_list.h"
#include "app/formats/volume/confined/file_requests.h"
#include "app/formats/volume/confined/volume_transfer.h"
#include "base/budget.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

/// Volume that a child keeps open.
class VolumeOfChild final : public OpenData {
 public:
  std::vector<std::byte> open(std::span<const std::byte> request, SharedBytes file, const ReadFile& ask) override {
    const auto known = volume_request_of(request);
    if (!known) return {};
    const WorldBudget budget = std::make_shared<Budget>(limits_of(known->left));
    VolumeOrigin origin{ask, known->name, known->component, files_by_asking(ask), folders_by_asking(ask)};
    if (known->by_parts) origin.need = parts_by_asking(ask);
    if (known->lists) return transfer_bytes(list_in_child(known->path, file, origin, budget));
    VolumeReply reply;
    origin.component.found = std::make_shared<DatasetList>();
    reply.volume = open_volume_file(known->path, file, known->raw, origin, budget);
    reply.datasets = std::move(*origin.component.found);
    reply.held = budget->used(Resource::volumes);
    std::vector<std::byte> bytes = transfer_bytes(reply);
    if (auto* const volume = std::get_if<qnv::VolumeSource>(&reply.volume)) {
      volume_ = std::move(*volume);
      sources_ = numbered_sources(volume_);
    }
    return bytes;
  }
  std::string trouble() const override { return volume_.trouble ? volume_.trouble() : std::string(); }
  bool read_slice(std::uint64_t source, std::uint64_t slice, std::span<std::byte> to) override {
    if (source >= sources_.size()) return false;
    const qnv::VolumeSource& one = *sources_[static_cast<std::size_t>(source)];
    return slice < one.layout.dimensions[2] && one.read(static_cast<std::uint32_t>(slice), to);
  }

  bool read_box(std::uint64_t source, const std::array<std::uint32_t, 9>& numbers, std::span<std::byte> to) override {
    if (source >= sources_.size()) return false;
    const qnv::VolumeSource& one = *sources_[static_cast<std::size_t>(source)];
    return one.read_box && qnv::read_voxels(one, voxel_box_of(numbers), to);
  }

 private:
  qnv::VolumeSource volume_;
  std::vector<const qnv::VolumeSource*> sources_;
};

}  // namespace

std::unique_ptr<OpenData> volume_of_child() { return std::make_unique<VolumeOfChild>(); }

}  // namespace gs::app
