#include "app/formats/datasets/module/hdf5_parts.h"

#include <algorithm>
#include <cstddef>
#include <vector>

// Look-up of the byte ranges of values, for a file on a server.
namespace gs::app {
namespace {

constexpr std::uint64_t kMostLookedUp = 4096;  // chunks of a box; larger boxes are received chunk by chunk

/// Adds the byte ranges of the chunks of a box. HDF5 looks up each chunk, and the driver then refuses to read it.
void look_up_chunks(Hdf5Source& source, hid_t dataset, hid_t type, const ArrayInfo& array, const ArrayBox& box,
                    std::vector<ByteSpan>& parts) {
  const std::vector<std::uint64_t>&first = box.first, &count = box.count;
  const std::size_t rank = array.chunk.size();
  std::vector<std::uint64_t> begin(rank), end(rank), at(rank);
  std::uint64_t chunks = 1;
  for (std::size_t i = 0; i < rank; ++i) {
    begin[i] = first[i] / array.chunk[i];
    end[i] = (first[i] + count[i] - 1) / array.chunk[i] + 1;
    if (chunks > kMostLookedUp / (end[i] - begin[i])) return;
    chunks *= end[i] - begin[i];
  }
  const Hdf5Handle space(H5Dget_space(dataset), H5Sclose);
  const std::vector<hsize_t> one(rank, 1);
  const Hdf5Handle memory(H5Screate_simple(static_cast<int>(rank), one.data(), nullptr), H5Sclose);
  std::vector<std::byte> value(std::max<std::size_t>(H5Tget_size(type), 1));
  if (!space || !memory) return;
  std::vector<ByteSpan> found;
  at = begin;
  for (;;) {
    std::vector<hsize_t> element(rank);
    for (std::size_t i = 0; i < rank; ++i) element[i] = std::max<std::uint64_t>(at[i] * array.chunk[i], first[i]);
    if (H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, element.data(), nullptr, one.data(), nullptr) < 0) return;
    source.looked_up = &found;
    (void)H5Dread(dataset, type, memory.get(), space.get(), H5P_DEFAULT, value.data());
    source.looked_up = nullptr;
    std::size_t axis = rank;
    for (; axis > 0; --axis) {
      if (++at[axis - 1] < end[axis - 1]) break;
      at[axis - 1] = begin[axis - 1];
    }
    if (axis == 0) break;
  }
  (void)H5Eclear2(H5E_DEFAULT);
  parts.insert(parts.end(), found.begin(), found.end());
}

}  // namespace

bool hdf5_need_boxes(Hdf5Source& source, hid_t dataset, hid_t type, const ArrayInfo& array,
                     std::span<const ArrayBox> boxes) {
  NeededParts needed(source.bytes.need);
  const std::size_t rank = array.shape.size(), element = H5Tget_size(type);
  if (!array.chunk.empty()) {
    const bool fits = array.chunk.size() == rank && std::ranges::find(array.chunk, 0u) == array.chunk.end();
    if (!fits || H5Tdetect_class(type, H5T_VLEN) > 0 || H5Tis_variable_str(type) > 0) return true;
    std::vector<ByteSpan> parts;
    for (const ArrayBox& box : boxes) look_up_chunks(source, dataset, type, array, box, parts);
    std::ranges::sort(parts, {}, &ByteSpan::offset);
    for (const ByteSpan& part : parts)
      if (!needed.add(part.offset, part.bytes)) return false;
    return needed.finish();
  }
  const haddr_t begin = H5Dget_offset(dataset);
  if (begin == HADDR_UNDEF || rank == 0) return true;
  std::vector<std::uint64_t> steps(rank, element);
  for (std::size_t i = rank; i-- > 1;) steps[i - 1] = steps[i] * array.shape[i];
  for (const ArrayBox& box : boxes) {
    std::uint64_t offset = begin;
    for (std::size_t i = 0; i < rank; ++i) offset += box.first[i] * steps[i];
    if (!needed.add_box(offset, steps, box.count, element)) return false;
  }
  return needed.finish();
}

}  // namespace gs::app
