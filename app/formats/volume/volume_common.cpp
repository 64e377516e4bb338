#include "app/formats/volume/volume_common.h"

#include "app/formats/common/text_cursor.h"
#include "base/finite.h"
#include "base/gzip.h"
#include "net/base/reference_policy.h"
#include "net/files/file.h"
#include "qnv/container/step_table.h"
#include "qnv/container/value_grid.h"
#include "qnv/sampling/volume/color_voxels.h"
#include "qnv/sampling/volume/volume_slices.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kLargeVoxelFile = std::size_t{256} << 20;  // larger ones leave memory while they are read

std::string plural(std::uint64_t count) { return std::to_string(count) + (count == 1 ? " byte" : " bytes"); }

qnv::VoxelType voxel_type_of(StoredType type) {
  return type < StoredType::u64 ? static_cast<qnv::VoxelType>(type) : qnv::VoxelType::f64;
}

// Converts a slice of 64-bit integers to doubles, in native byte order.
template <class T>
void widen(const std::byte* from, std::size_t step, bool big_endian, std::span<std::byte> to) {
  const bool swap = big_endian != (std::endian::native == std::endian::big);
  for (std::size_t i = 0; i < to.size() / sizeof(double); ++i) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, from + i * step, sizeof(bits));
    const auto value = static_cast<double>(static_cast<T>(swap ? __builtin_bswap64(bits) : bits));
    std::memcpy(to.data() + i * sizeof(double), &value, sizeof(value));
  }
}

/// Computes the lengths of the vectors of a slice. A vector with a missing component has the length NaN.
void read_magnitudes(const StoredVoxels& voxels, const qnv::VolumeLayout& stored, const std::byte* from,
                     std::span<std::byte> to) {
  const std::size_t count = to.size() / sizeof(float), numbers = voxels.components, size = size_of(voxels.type);
  std::vector<std::byte> joined;  // voxels with components that followed each other
  constexpr std::size_t kPiece = 4096;
  std::vector<float> values(std::min(count, kPiece) * numbers);
  std::vector<std::byte> wide;
  for (std::size_t begin = 0; begin < count; begin += kPiece) {
    const std::size_t voxels_here = std::min(kPiece, count - begin), here = voxels_here * numbers;
    std::span<const std::byte> bytes;
    if (voxels.plane > 0) {
      joined.resize(here * size);
      for (std::size_t k = 0; k < numbers; ++k)
        for (std::size_t i = 0; i < voxels_here; ++i)
          std::memcpy(&joined[(i * numbers + k) * size], from + (k * voxels.plane + begin + i) * size, size);
      bytes = joined;
    } else {
      bytes = {from + begin * numbers * size, here * size};
    }
    if (voxels.type >= StoredType::u64) {
      wide.resize(here * sizeof(double));
      if (voxels.type == StoredType::u64)
        widen<std::uint64_t>(bytes.data(), size, voxels.big_endian, wide);
      else
        widen<std::int64_t>(bytes.data(), size, voxels.big_endian, wide);
      bytes = wide;
    }
    qnv::values_of(stored, bytes, std::span(values).first(here));
    for (std::size_t i = 0; i < voxels_here; ++i) {
      double square = 0;
      for (std::size_t k = 0; k < numbers; ++k) {
        const auto value = static_cast<double>(values[i * numbers + k]);
        square += value * value;
      }
      const auto length = static_cast<float>(std::sqrt(square));
      std::memcpy(to.data() + (begin + i) * sizeof(float), &length, sizeof(length));
    }
  }
}

/// Makes a slice readable if a server has the file. `slice_voxels` is the number of its voxels.
bool have_slice(const StoredVoxels& voxels, std::uint64_t slice_voxels, std::uint32_t z) {
  if (!voxels.content.need) return true;
  const bool follow = voxels.plane > 0;
  const std::uint64_t size = size_of(voxels.type), step = follow ? size : size * voxels.components;
  const std::uint64_t begin = voxels.offset + slice_voxels * step * z;
  if (!follow) return have_bytes(voxels.content.need, begin, slice_voxels * step);
  NeededParts needed(voxels.content.need);
  const std::uint64_t first = voxels.component.magnitude ? 0 : voxels.component.index;
  const std::uint64_t end = voxels.component.magnitude ? voxels.components : first + 1;
  for (std::uint64_t k = first; k < end; ++k)
    if (!needed.add(begin + k * size * voxels.plane, slice_voxels * size)) return false;
  return needed.finish();
}

/// Makes a box readable if a server has the file. `begin` is the offset of the first voxel, `step` the size of a voxel.
bool have_box(const StoredVoxels& voxels, std::uint64_t begin, std::size_t step,
              const std::array<std::uint32_t, 3>& dimensions, const qnv::VoxelBox& box) {
  if (!voxels.content.need) return true;
  constexpr std::uint64_t kRowGap = 4096;
  const std::uint64_t along = std::uint64_t{step} * box.step[0], row = std::uint64_t{step} * dimensions[0];
  const std::uint64_t number = size_of(voxels.type);
  const std::array<std::uint64_t, 2> steps{row * dimensions[1] * box.step[2], row * box.step[1]};
  begin += box.first[2] * row * dimensions[1] + box.first[1] * row + box.first[0] * step;
  NeededParts needed(voxels.content.need);
  if (along > kRowGap) {
    const std::array<std::uint64_t, 3> all{steps[0], steps[1], along};
    const std::array<std::uint64_t, 3> samples{box.size[2], box.size[1], box.size[0]};
    return needed.add_box(begin, all, samples, number) && needed.finish();
  }
  const std::array<std::uint64_t, 2> rows{box.size[2], box.size[1]};
  return needed.add_box(begin, steps, rows, along * (box.size[0] - 1) + number) && needed.finish();
}

bool read_stored(const StoredVoxels& voxels, std::uint64_t slice_voxels, std::uint32_t z, std::span<std::byte> to) {
  const bool follow = voxels.plane > 0;  // the components follow each other
  const std::size_t size = size_of(voxels.type), step = follow ? size : size * voxels.components;
  const bool wide = voxels.type >= StoredType::u64;
  if (to.size() != slice_voxels * (wide ? sizeof(double) : size) || !have_slice(voxels, slice_voxels, z)) return false;
  const std::byte* from = voxels.content.bytes.data() + voxels.offset + slice_voxels * step * z +
                          voxels.component.index * size * (follow ? voxels.plane : 1);
  if (wide) {
    if (voxels.type == StoredType::u64)
      widen<std::uint64_t>(from, step, voxels.big_endian, to);
    else
      widen<std::int64_t>(from, step, voxels.big_endian, to);
  } else if (step == size) {
    std::memcpy(to.data(), from, to.size());
  } else {
    for (std::uint64_t i = 0; i < slice_voxels; ++i) std::memcpy(to.data() + i * size, from + i * step, size);
  }
  if (!voxels.content.file) return true;
  if (voxels.content.bytes.size() >= kLargeVoxelFile)
    voxels.content.file->put_aside(
        static_cast<std::size_t>(voxels.offset + slice_voxels * step * (z + std::uint64_t{1})));
  return !voxels.content.file->changed();
}

// Reads the voxels of a box. It must lie in the volume.
bool read_stored_box(const StoredVoxels& voxels, const std::array<std::uint32_t, 3>& dimensions,
                     const qnv::VoxelBox& box, std::span<std::byte> to) {
  const bool follow = voxels.plane > 0;
  const std::size_t size = size_of(voxels.type), step = follow ? size : size * voxels.components;
  const bool wide = voxels.type >= StoredType::u64;
  const std::size_t out = wide ? sizeof(double) : size;
  if (!qnv::lies_in(box, dimensions) || to.size() != qnv::voxel_count(box) * out) return false;
  const std::uint64_t first = voxels.offset + voxels.component.index * size * (follow ? voxels.plane : 1);
  if (!have_box(voxels, first, step, dimensions, box)) return false;
  const std::byte* const begin = voxels.content.bytes.data() + first;
  const std::size_t along = step * box.step[0];
  for (std::uint32_t z = 0; z < box.size[2]; ++z)
    for (std::uint32_t y = 0; y < box.size[1]; ++y) {
      const std::uint64_t row = (box.first[2] + std::uint64_t{z} * box.step[2]) * dimensions[1] +
                                (box.first[1] + std::uint64_t{y} * box.step[1]);
      const std::byte* from = begin + (row * dimensions[0] + box.first[0]) * step;
      const auto line = to.subspan((std::size_t{z} * box.size[1] + y) * box.size[0] * out, box.size[0] * out);
      if (voxels.type == StoredType::u64)
        widen<std::uint64_t>(from, along, voxels.big_endian, line);
      else if (wide)
        widen<std::int64_t>(from, along, voxels.big_endian, line);
      else if (along == size)
        std::memcpy(line.data(), from, line.size());
      else
        for (std::size_t i = 0; i < line.size(); i += size, from += along) std::memcpy(line.data() + i, from, size);
    }
  if (!voxels.content.file) return true;
  if (voxels.content.bytes.size() >= kLargeVoxelFile) voxels.content.file->put_aside(voxels.content.bytes.size());
  return !voxels.content.file->changed();
}

auto box_reader(const StoredVoxels& voxels, const std::array<std::uint32_t, 3>& dimensions) {
  return [voxels, dimensions](const qnv::VoxelBox& box, std::span<std::byte> to) {
    return read_stored_box(voxels, dimensions, box, to);
  };
}

// Converts doubles to a smaller type, in place. If a value does not fit, returns false and changes nothing.
template <class T>
bool narrow(std::span<std::byte> bytes) {
  const std::size_t count = bytes.size() / sizeof(double);
  const auto at = [&](std::size_t i) {
    double value = 0;
    std::memcpy(&value, bytes.data() + i * sizeof(double), sizeof(value));
    return value;
  };
  if constexpr (std::is_integral_v<T>)
    for (std::size_t i = 0; i < count; ++i)
      if (const double value = at(i); !(value >= static_cast<double>(std::numeric_limits<T>::min()) &&
                                        value <= static_cast<double>(std::numeric_limits<T>::max())) ||
                                      value != std::trunc(value))
        return false;
  if constexpr (!std::is_integral_v<T>)
    for (std::size_t i = 0; i < count; ++i)
      if (const double size = std::abs(at(i));
          size > static_cast<double>(std::numeric_limits<T>::max()) && std::isfinite(size))
        return false;
  for (std::size_t i = 0; i < count; ++i) {
    const T value = static_cast<T>(at(i));
    std::memcpy(bytes.data() + i * sizeof(T), &value, sizeof(value));
  }
  return true;
}

bool narrowed(std::span<std::byte> numbers, StoredType type) {
  return type < StoredType::f64 && with_stored_type(type, [&](auto kind) { return narrow<decltype(kind)>(numbers); });
}

}  // namespace

std::size_t size_of(StoredType type) { return type < StoredType::u64 ? qnv::size_of(voxel_type_of(type)) : 8; }

SharedBytes shared_bytes(VoxelMemory memory) {
  auto owner = std::make_shared<const VoxelMemory>(std::move(memory));
  return {owner, std::span<const std::byte>(owner->bytes)};
}

std::variant<VoxelMemory, std::string> voxel_memory(std::uint64_t from, std::uint64_t size, const WorldBudget& budget) {
  constexpr std::uint64_t kMaxDeflateRatio = 1032;
  if (size / kMaxDeflateRatio > from) return plural(from) + " of compressed data cannot contain " + plural(size);
  VoxelMemory memory;
  memory.share = Share(budget, Resource::volumes);
  if (!memory.share.grow(size)) return plural(size) + " are " + budget->refusal(Resource::volumes);
  memory.bytes.resize(size);
  return memory;
}

std::optional<std::string> unpack_into(std::span<const std::byte> bytes, std::span<std::byte> out,
                                       const WorldBudget& budget) {
  constexpr std::size_t kPiece = std::size_t{1} << 24;  // number of bytes between two checks of the time limit
  constexpr int kZlibOrGzip = 15 + 32;
  z_stream stream{};
  if (inflateInit2(&stream, kZlibOrGzip) != Z_OK) return "zlib cannot be initialised";
  std::size_t given = 0, made = 0;
  int status = Z_OK;
  while (made < out.size() && status == Z_OK && !budget->stopped()) {
    const auto in = static_cast<uInt>(std::min<std::size_t>(bytes.size() - given, std::numeric_limits<uInt>::max()));
    const auto room = static_cast<uInt>(std::min(out.size() - made, kPiece));
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<std::byte*>(bytes.data() + given));
    stream.avail_in = in;
    stream.next_out = reinterpret_cast<Bytef*>(out.data() + made);
    stream.avail_out = room;
    status = inflate(&stream, Z_NO_FLUSH);
    given += in - stream.avail_in;
    made += room - stream.avail_out;
  }
  inflateEnd(&stream);
  if (made == out.size()) return std::nullopt;
  return "the compressed data " + std::string(status == Z_DATA_ERROR ? "is damaged" : "ends") + " after " +
         plural(made) + "; expected " + std::to_string(out.size());
}

BytesResult unpacked_exactly(std::span<const std::byte> bytes, std::uint64_t size, const WorldBudget& budget) {
  auto made = voxel_memory(bytes.size(), size, budget);
  if (auto* problem = std::get_if<std::string>(&made)) return std::move(*problem);
  auto& memory = std::get<VoxelMemory>(made);
  if (const auto problem = unpack_into(bytes, memory.bytes, budget)) return *problem;
  return shared_bytes(std::move(memory));
}

BytesResult unpacked_gzip(std::span<const std::byte> bytes, const WorldBudget& budget) {
  auto unpacked = std::make_shared<const UnpackedBytes>(unpack_gzip(bytes, budget, Resource::volumes));
  if (unpacked->problem) return *unpacked->problem;
  return SharedBytes{unpacked, unpacked->bytes.span()};
}

BytesResult unpacked_file(const std::string& path, const SharedBytes& file, const WorldBudget& budget) {
  if (!is_gzip(file.bytes)) return file;
  BytesResult unpacked = unpacked_gzip(file.bytes, budget);
  if (const auto changed = file.file ? file.file->changed() : std::nullopt) return path + ": " + *changed;
  if (const auto* problem = std::get_if<std::string>(&unpacked)) return path + ": " + *problem;
  return unpacked;
}

BytesResult load_beside(const VolumeFile& file, std::string_view name) {
  if (name.empty() || name.size() > 4096 || name.find('\0') != std::string_view::npos)
    return std::string("the name of the data file is invalid; expected a file name");
  if (!file.read_beside) return std::string("the data file: other files are not read here");
  const std::string reference = net::reference_of_path(name);
  BytesResult loaded = file.read_beside(reference);
  // The folder in the reference may be outdated. Retry with the file name alone.
  const std::string alone = reference.substr(reference.rfind('/') + 1);  // all of it without '/'
  if (std::holds_alternative<std::string>(loaded) && !alone.empty() && alone != reference)
    if (BytesResult beside = file.read_beside(alone); std::holds_alternative<SharedBytes>(beside))
      loaded = std::move(beside);
  if (const auto* problem = std::get_if<std::string>(&loaded)) return "the data file: " + *problem;
  const SharedBytes& bytes = std::get<SharedBytes>(loaded);
  return is_gzip(bytes.bytes) ? unpacked_gzip(bytes.bytes, file.budget) : loaded;
}

std::variant<std::uint64_t, std::string> stored_size(const qnv::VolumeLayout& layout, StoredType type,
                                                     std::uint64_t components) {
  qnv::VolumeLayout plain;
  plain.dimensions = layout.dimensions;
  if (const auto problem = qnv::check(plain)) return problem->message;
  constexpr std::uint64_t kMaxComponents = 1u << 12;
  if (components == 0 || components > kMaxComponents)
    return std::to_string(components) + " components per voxel; expected 1 to " + std::to_string(kMaxComponents);
  return qnv::voxel_count(layout) * size_of(type) * components;  // below 2^(48 + 3 + 12)
}

void set_base(qnv::VolumeLayout& layout) {
  WideBox box;
  for (unsigned corner = 0; corner < 8; ++corner) {
    glm::dvec3 place = layout.origin;
    for (unsigned i = 0; i < 3; ++i)
      if (corner >> i & 1) place += glm::dvec3(layout.axes[i]) * (static_cast<double>(layout.dimensions[i]) - 1);
    box.add(place);
  }
  layout.base = qnv::local_origin(box);
  layout.origin -= layout.base;
}

VolumeResult make_source(qnv::VolumeLayout layout, StoredVoxels voxels) {
  const auto needed = stored_size(layout, voxels.type, voxels.components);
  if (const auto* problem = std::get_if<std::string>(&needed)) return *problem;
  std::uint64_t size = std::get<std::uint64_t>(needed);
  const std::uint64_t all = voxels.content.bytes.size();
  // Other steps lie between the components.
  if (voxels.plane > 0)
    size = ((voxels.components - 1) * voxels.plane + qnv::voxel_count(layout)) * size_of(voxels.type);
  const std::uint64_t there = voxels.offset < all ? all - voxels.offset : 0;
  if (there < size) {
    const auto [x, y, z] = layout.dimensions;
    return std::to_string(x) + " x " + std::to_string(y) + " x " + std::to_string(z) + " voxels need " + plural(size) +
           "; there are " + std::to_string(there);
  }
  const VoxelComponent chosen = voxels.component;
  if (!chosen.magnitude && chosen.index >= voxels.components)
    return "no component " + std::to_string(chosen.index) + "; expected " +
           (voxels.components == 1 ? "0, because each voxel has one number"
                                   : "0 to " + std::to_string(voxels.components - 1) + ", or magnitude");
  layout.labels = chosen.labels.value_or(layout.labels) && !chosen.magnitude;
  layout.colors = layout.colors && voxels.type == StoredType::u8 && !layout.missing && !layout.labels &&
                  !chosen.chosen && !chosen.magnitude && (voxels.components == 3 || voxels.components == 4);
  if (layout.colors) layout.slope = 1, layout.intercept = 0;
  mend(layout);
  set_base(layout);
  layout.type = voxel_type_of(voxels.type);
  const bool wide = voxels.type >= StoredType::u64;
  layout.big_endian = wide ? std::endian::native == std::endian::big : voxels.big_endian;
  if (const auto problem = qnv::check(layout)) return problem->message;
  qnv::VolumeSource source;
  const std::uint64_t slice = qnv::slice_voxels(layout);
  const std::uint32_t slices = layout.dimensions[2];
  if (voxels.components > 1)
    add_metadata(layout, "component",
                 chosen.magnitude ? "magnitude of " + std::to_string(voxels.components)
                                  : std::to_string(chosen.index) + " of " + std::to_string(voxels.components));
  if (chosen.magnitude && voxels.components > 1) {
    source.layout = layout;
    source.layout.type = qnv::VoxelType::f32;
    source.layout.big_endian = std::endian::native == std::endian::big;
    source.layout.slope = 1;
    source.layout.intercept = 0;
    source.layout.missing.reset();
    source.read = [voxels = std::move(voxels), stored = std::move(layout), slice, slices](std::uint32_t z,
                                                                                          std::span<std::byte> to) {
      if (z >= slices || to.size() != slice * sizeof(float) || !have_slice(voxels, slice, z)) return false;
      const std::size_t step = size_of(voxels.type) * (voxels.plane > 0 ? 1 : voxels.components);
      read_magnitudes(voxels, stored, voxels.content.bytes.data() + voxels.offset + slice * step * z, to);
      return !voxels.content.file || !voxels.content.file->changed();
    };
    return source;
  }
  source.layout = std::move(layout);
  if (voxels.components > 1 && voxels.components <= qnv::kMaxValueComponents && !chosen.chosen && !source.layout.labels)
    for (std::uint32_t i = 0; i < voxels.components; ++i) {
      VoxelComponent one;
      one.index = i;
      one.chosen = true;
      StoredVoxels of_one = voxels;
      of_one.component = one;
      source.components.push_back({source.layout, [of_one, slice, slices](std::uint32_t z, std::span<std::byte> to) {
                                     return z < slices && read_stored(of_one, slice, z, to);
                                   }});
      source.components.back().read_box = box_reader(of_one, source.layout.dimensions);
      std::erase_if(source.components.back().layout.metadata,
                    [](const auto& pair) { return pair.first == "component"; });
    }
  if (source.layout.colors) return qnv::color_source(std::move(source.components));
  source.read_box = box_reader(voxels, source.layout.dimensions);
  source.read = [voxels = std::move(voxels), slice, slices](std::uint32_t z, std::span<std::byte> to) {
    return z < slices && read_stored(voxels, slice, z, to);
  };
  return source;
}

VolumeResult make_series(const qnv::VolumeLayout& layout, const StoredVoxels& voxels, std::vector<double> times) {
  if (times.size() < 2) return make_source(layout, voxels);
  if (times.size() > qnv::kMaxSteps)
    return std::to_string(times.size()) + " steps; expected at most " + std::to_string(qnv::kMaxSteps);
  const auto size = stored_size(layout, voxels.type, voxels.plane > 0 ? 1 : voxels.components);
  if (const auto* problem = std::get_if<std::string>(&size)) return *problem;
  const auto at = [&](std::size_t step) {
    StoredVoxels one = voxels;
    one.offset += std::get<std::uint64_t>(size) * step;
    return make_source(layout, std::move(one));
  };
  if (const auto& chosen = voxels.component.step) {
    if (!chosen->time && chosen->number >= times.size())
      return "no step " + std::to_string(chosen->number) + "; expected 0 to " + std::to_string(times.size() - 1);
    return at(qnv::step_number(*chosen, times));
  }
  std::vector<qnv::VolumeSource> steps;
  for (std::size_t step = 0; step < times.size(); ++step) {
    VolumeResult made = at(step);
    if (auto* problem = std::get_if<std::string>(&made)) return "step " + std::to_string(step) + ": " + *problem;
    steps.push_back(std::move(std::get<qnv::VolumeSource>(made)));
  }
  qnv::VolumeSource source = steps.front();
  source.steps = std::move(steps);
  source.times = std::move(times);
  return source;
}

std::variant<StoredVoxels, std::string> voxels_of_text(std::span<const std::byte> text, std::uint64_t count,
                                                       StoredType type, const WorldBudget& budget) {
  if (count > (text.size() + 1) / 2)
    return "a text of " + plural(text.size()) + " cannot contain " + std::to_string(count) + " numbers";
  auto made = voxel_memory(text.size(), count * sizeof(double), budget);
  if (auto* problem = std::get_if<std::string>(&made)) return std::move(*problem);
  auto& out = std::get<VoxelMemory>(made);
  TextCursor cursor(text);
  for (std::uint64_t i = 0; i < count; ++i) {
    while (cursor.skip_space() && *cursor.next == ',') ++cursor.next;
    double value = 0;
    if (!cursor.number(value))
      return "the text contains " + std::to_string(i) + " numbers; expected " + std::to_string(count);
    std::memcpy(out.bytes.data() + i * sizeof(double), &value, sizeof(value));
  }
  StoredVoxels voxels;
  voxels.type = narrowed(out.bytes, type) ? type : StoredType::f64;
  voxels.content = shared_bytes(std::move(out));
  voxels.big_endian = std::endian::native == std::endian::big;
  return voxels;
}

void mend(qnv::VolumeLayout& layout) {
  if (!finite(layout.origin)) layout.origin = glm::dvec3(0);
  if (!std::isfinite(layout.slope) || layout.slope == 0) layout.slope = 1;
  if (!std::isfinite(layout.intercept)) layout.intercept = 0;
  qnv::VolumeLayout space;
  space.dimensions = {1, 1, 1};
  space.axes = layout.axes;
  if (qnv::check(space)) layout.axes = qnv::VolumeLayout{}.axes;
  space.axes = layout.axes;
  space.origin = layout.origin;
  if (qnv::check(space)) layout.origin = glm::dvec3(0);
}

std::vector<double> numbers_of(std::string_view text, std::size_t most) {
  std::vector<double> numbers;
  TextCursor cursor(text.data(), text.data() + text.size());
  const auto parts = [](char c) { return TextCursor::is_space(c) || std::string_view(",()[]{}").find(c) < 7; };
  while (numbers.size() < most) {
    while (!cursor.at_end() && parts(*cursor.next)) ++cursor.next;
    double value = 0;
    if (cursor.at_end() || !cursor.number(value)) break;
    numbers.push_back(value);
  }
  return numbers;
}

std::optional<std::array<std::uint32_t, 3>> dimensions_of(std::span<const double> numbers) {
  if (numbers.empty() || numbers.size() > 3) return std::nullopt;
  std::array<std::uint32_t, 3> dimensions{1, 1, 1};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (!(numbers[i] >= 1 && numbers[i] <= 4294967295.0) || numbers[i] != std::floor(numbers[i])) return std::nullopt;
    dimensions[i] = static_cast<std::uint32_t>(numbers[i]);
  }
  return dimensions;
}

void add_metadata(qnv::VolumeLayout& layout, std::string_view key, std::string_view value) {
  constexpr std::size_t kMaxBytes = 4096, kMaxPairs = 256;
  key = trimmed(key.substr(0, std::min(key.find('\0'), kMaxBytes)));
  value = trimmed(value.substr(0, std::min(value.find('\0'), kMaxBytes)));
  if (key.empty() || value.empty() || layout.metadata.size() >= kMaxPairs) return;
  // Headers should be ASCII. The encoding of other bytes is unknown.
  const auto plain = [](std::string_view text) {
    std::string result(text);
    for (char& c : result)
      if ((c & 0x80) != 0 || (c >= 0 && c < 0x20 && c != '\n' && c != '\t')) c = '?';
    return result;
  };
  layout.metadata.emplace_back(plain(key), plain(value));
}

}  // namespace gs::app
