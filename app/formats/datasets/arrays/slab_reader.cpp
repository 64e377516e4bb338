#include "app/formats/datasets/arrays/slab_reader.h"

#include "net/files/file.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

constexpr std::uint64_t kLeastSlab = std::uint64_t{1} << 20, kMostSlabs = std::uint64_t{256} << 20;
constexpr std::uint64_t kMostPart = std::uint64_t{1} << 30;
constexpr std::size_t kLargeFile = std::size_t{256} << 20;  // files that are read slice by slice leave memory again

}  // namespace

SlabReader::SlabReader(const DatasetTree& tree)
    : file_(tree.file()), content_(tree.content()), budget_(tree.budget()), share_(tree.budget(), Resource::volumes) {
  most_bytes_ = static_cast<std::size_t>(std::clamp(budget_->left(Resource::volumes) / 4, kLeastSlab, kMostSlabs));
}

std::shared_ptr<const std::vector<std::byte>> SlabReader::read(const ArraySlice& slice, std::size_t& offset,
                                                               std::vector<std::uint64_t>& counts) {
  const std::scoped_lock lock(mutex_);
  const auto holds = [&](const Slab& slab) {
    if (slab.array != slice.array || slab.first.size() != slice.first.size()) return false;
    for (std::size_t i = 0; i < slice.first.size(); ++i)
      if (i == slice.along ? slice.first[i] < slab.first[i] || slice.first[i] >= slab.first[i] + slab.count[i]
                           : slice.first[i] != slab.first[i] || slice.count[i] != slab.count[i])
        return false;
    return true;
  };
  auto found = std::ranges::find_if(slabs_, holds);
  if (found == slabs_.end()) {
    const ArrayInfo& array = file_->arrays()[slice.array];
    Slab slab{slice.array, slice.first, slice.count, nullptr};
    std::uint64_t bytes = size_of(array.type) * array.parts;
    for (const std::uint64_t count : slice.count) {
      if (count > 0 && bytes > most_bytes_ / count && bytes > (std::uint64_t{1} << 40) / count) return nullptr;
      bytes *= count;
    }
    if (slice.along) {
      // As many slices as a chunk has, and enough of them to be worth a call.
      const std::size_t axis = *slice.along;
      const std::uint64_t chunk = axis < array.chunk.size() ? std::max<std::uint64_t>(array.chunk[axis], 1) : 1;
      const std::uint64_t wanted =
          std::max(chunk, (kLeastSlab / std::max<std::uint64_t>(bytes, 1) + chunk) / chunk * chunk);
      std::uint64_t depth =
          std::min(wanted, std::max<std::uint64_t>(most_bytes_ / 2 / std::max<std::uint64_t>(bytes, 1), 1));
      if (depth >= chunk) depth = depth / chunk * chunk;
      slab.first[axis] = slice.first[axis] / depth * depth;
      slab.count[axis] = std::min(depth, array.shape[axis] - slab.first[axis]);
      bytes *= slab.count[axis];
    }
    while (!slabs_.empty() && share_.amount() + bytes > most_bytes_) {
      share_.shrink_to(share_.amount() - slabs_.back().bytes->size());
      slabs_.pop_back();
    }
    if (!share_.grow(bytes)) return nullptr;
    auto made = std::make_shared<std::vector<std::byte>>(static_cast<std::size_t>(bytes));
    const bool read = file_->read(slab.array, slab.first, slab.count, *made).empty();
    if (!read || (content_.file && content_.file->changed())) {
      share_.shrink_to(share_.amount() - bytes);
      return nullptr;
    }
    if (content_.file && content_.bytes.size() >= kLargeFile) content_.file->put_aside(content_.bytes.size());
    slab.bytes = std::move(made);
    slabs_.push_front(std::move(slab));
    found = slabs_.begin();
  } else if (found != slabs_.begin()) {
    slabs_.splice(slabs_.begin(), slabs_, found);
  }
  const Slab& slab = *found;
  const ArrayInfo& array = file_->arrays()[slab.array];
  offset = 0;
  if (slice.along) {
    std::uint64_t step = size_of(array.type) * array.parts;
    for (std::size_t i = *slice.along + 1; i < slab.count.size(); ++i) step *= slab.count[i];
    offset = static_cast<std::size_t>(step * (slice.first[*slice.along] - slab.first[*slice.along]));
  }
  counts = slab.count;
  return slab.bytes;
}

bool SlabReader::read_part(std::size_t array, std::span<const std::uint64_t> first,
                           std::span<const std::uint64_t> count, std::vector<std::byte>& to) {
  const std::scoped_lock lock(mutex_);
  const ArrayInfo& info = file_->arrays()[array];
  std::uint64_t bytes = size_of(info.type) * info.parts;
  for (const std::uint64_t one : count) {
    if (one > kMostPart / bytes) return false;
    bytes *= one;
  }
  if (bytes > budget_->left(Resource::volumes)) return false;
  to.resize(static_cast<std::size_t>(bytes));
  return file_->read(array, first, count, to).empty();
}

void SlabReader::prepare(std::size_t array, std::span<const ArrayBox> boxes) {
  const std::scoped_lock lock(mutex_);
  file_->prepare(array, boxes);
}

void SlabReader::put_aside() {
  const std::scoped_lock lock(mutex_);
  if (content_.file && content_.bytes.size() >= kLargeFile) content_.file->put_aside(content_.bytes.size());
}

}  // namespace gs::app
