#include "app/formats/datasets/module/hdf5_driver.h"

#include "app/formats/datasets/module/hdf5_filters.h"

#include <algorithm>
#include <cstring>

// File driver of HDF5 that reads bytes in memory. It opens no path: links to other files and virtual datasets with
// other files cannot be followed.

namespace gs::app {
namespace {

constexpr const char* kMemoryName = "/bytes-in-memory";  // for a relative name, HDF5 asks for the current folder

/// Value of the property list through which HDF5 passes the source to the driver.
struct MemoryProperty {
  Hdf5Source* source = nullptr;
};

struct MemoryFile {
  H5FD_t base{};  // first member, as HDF5 requires
  Hdf5Source* source = nullptr;
  haddr_t end = 0;

  [[nodiscard]] std::span<const std::byte> bytes() const { return source->bytes.bytes; }
};

MemoryFile* memory_file(H5FD_t* file) { return reinterpret_cast<MemoryFile*>(file); }
const MemoryFile* memory_file(const H5FD_t* file) { return reinterpret_cast<const MemoryFile*>(file); }

H5FD_t* open_memory(const char* name, unsigned flags, hid_t properties, haddr_t) {
  const auto* const property = static_cast<const MemoryProperty*>(H5Pget_driver_info(properties));
  if (!property || (flags & H5F_ACC_RDWR) != 0 || std::strcmp(name, kMemoryName) != 0) return nullptr;
  auto* const file = new (std::nothrow) MemoryFile;
  if (file) file->source = property->source;
  return file ? &file->base : nullptr;
}

herr_t close_memory(H5FD_t* file) {
  delete memory_file(file);
  return 0;
}

int compare_memory(const H5FD_t* one, const H5FD_t* other) {
  const auto *const a = memory_file(one)->bytes().data(), *const b = memory_file(other)->bytes().data();
  return a < b ? -1 : a > b ? 1 : 0;
}

herr_t query_memory(const H5FD_t*, unsigned long* flags) {
  if (flags) *flags = H5FD_FEAT_SUPPORTS_SWMR_IO;
  return 0;
}

// A program that writes with SWMR allocates bytes behind the end that the file states.
haddr_t end_of_allocation(const H5FD_t* file, H5FD_mem_t) {
  return std::max<haddr_t>(memory_file(file)->end, memory_file(file)->bytes().size());
}
herr_t set_end_of_allocation(H5FD_t* file, H5FD_mem_t, haddr_t end) {
  memory_file(file)->end = end;
  return 0;
}
haddr_t end_of_file(const H5FD_t* file, H5FD_mem_t) { return memory_file(file)->bytes().size(); }

herr_t read_memory(H5FD_t* file, H5FD_mem_t type, hid_t, haddr_t place, std::size_t size, void* to) {
  Hdf5Source& source = *memory_file(file)->source;
  const std::span<const std::byte> bytes = source.bytes.bytes;
  if (place > bytes.size() || size > bytes.size() - place) return -1;
  if (source.looked_up && type == H5FD_MEM_DRAW) {
    source.looked_up->push_back({place, size});
    return -1;
  }
  if (!have_bytes(source.bytes.need, place, size)) return -1;
  std::memcpy(to, bytes.data() + place, size);
  return 0;
}
herr_t write_memory(H5FD_t*, H5FD_mem_t, hid_t, haddr_t, std::size_t, const void*) { return -1; }

H5FD_class_t memory_driver() {
  H5FD_class_t driver{};
  driver.name = "ghostspace_memory";
  driver.maxaddr = (haddr_t{1} << 62) - 1;
  driver.fc_degree = H5F_CLOSE_STRONG;
  driver.fapl_size = sizeof(MemoryProperty);
  driver.open = open_memory;
  driver.close = close_memory;
  driver.cmp = compare_memory;
  driver.query = query_memory;
  driver.get_eoa = end_of_allocation;
  driver.set_eoa = set_end_of_allocation;
  driver.get_eof = end_of_file;
  driver.read = read_memory;
  driver.write = write_memory;
  for (H5FD_mem_t& type : driver.fl_map) type = H5FD_MEM_SUPER;
  return driver;
}

hid_t memory_driver_id() {
  static const H5FD_class_t driver = memory_driver();
  static const hid_t id = H5FDregister(&driver);
  return id;
}

std::recursive_mutex& hdf5_mutex() {
  static std::recursive_mutex mutex;
  return mutex;
}

}  // namespace

Hdf5Scope::Hdf5Scope() : lock_(hdf5_mutex()) {
  (void)H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // of this thread
  static const bool prepared = [] {
    (void)H5PLset_loading_state(0);
    (void)H5Lunregister(H5L_TYPE_EXTERNAL);
    register_hdf5_filters();
    return memory_driver_id() >= 0;
  }();
  (void)prepared;
}

std::string hdf5_problem(std::string otherwise) {
  std::string found;
  (void)H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned, const H5E_error2_t* error, void* to) -> herr_t {
        auto& text = *static_cast<std::string*>(to);
        if (text.empty() && error->desc) text = error->desc;
        return 0;
      },
      &found);
  (void)H5Eclear2(H5E_DEFAULT);
  constexpr std::size_t kLongest = 160;
  if (found.size() > kLongest) found.resize(kLongest);
  return found.empty() ? std::move(otherwise) : otherwise + " (" + found + ")";
}

Hdf5Handle open_hdf5_bytes(Hdf5Source& source) {
  const Hdf5Handle properties(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  const MemoryProperty memory{&source};
  if (!properties || H5Pset_driver(properties.get(), memory_driver_id(), &memory) < 0 ||
      H5Pset_fclose_degree(properties.get(), H5F_CLOSE_STRONG) < 0)
    return {};
  // Rows are already received together. A sieve buffer of HDF5 would also read the bytes between them.
  if (source.bytes.need) (void)H5Pset_sieve_buf_size(properties.get(), 0);
  const hid_t opened = H5Fopen(kMemoryName, H5F_ACC_RDONLY, properties.get());
  // A file that a program writes with SWMR opens only with SWMR.
  return {opened >= 0 ? opened : H5Fopen(kMemoryName, H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, properties.get()), H5Fclose};
}

}  // namespace gs::app
