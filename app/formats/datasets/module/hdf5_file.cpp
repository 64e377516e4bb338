#include "app/formats/datasets/module/hdf5_file.h"

#include "app/formats/datasets/module/hdf5_parts.h"
#include "app/formats/datasets/module/hdf5_types.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kMostObjects = 100'000, kMostOpen = 16;

// Names of filters that are not part of HDF5, by the numbers that The HDF Group registered.
constexpr std::pair<int, const char*> kFilterNames[] = {{307, "bzip2"},       {32000, "LZF"},        {32001, "Blosc"},
                                                        {32004, "LZ4"},       {32008, "bitshuffle"}, {32013, "ZFP"},
                                                        {32015, "Zstandard"}, {32017, "SZ"},         {32026, "Blosc2"}};

std::string filter_problem(hid_t properties) {
  const int filters = H5Pget_nfilters(properties);
  for (int i = 0; i < filters; ++i) {
    unsigned flags = 0, configuration = 0;
    std::size_t values = 0;
    std::array<char, 64> name{};
    const H5Z_filter_t filter = H5Pget_filter2(properties, static_cast<unsigned>(i), &flags, &values, nullptr,
                                               name.size(), name.data(), &configuration);
    if (filter < 0 || H5Zfilter_avail(filter) > 0) continue;
    const auto* const known =
        std::ranges::find(kFilterNames, static_cast<int>(filter), &std::pair<int, const char*>::first);
    return "it is compressed by " +
           (known != std::end(kFilterNames) ? std::string(known->second)
                                            : "the unknown filter " + std::string(name.data())) +
           " (HDF5 filter " + std::to_string(filter) + "), which cannot be read here; h5repack -f GZIP=1 converts it";
  }
  return {};
}

/// Returns the reason why the elements of a dataset lie elsewhere or cannot be decoded, or an empty text.
std::string storage_problem(hid_t properties, ArrayInfo& array) {
  const H5D_layout_t layout = H5Pget_layout(properties);
  if (H5Pget_external_count(properties) > 0) return "its values lie in other files, which are not read";
  if (layout == H5D_VIRTUAL) {
    std::size_t sources = 0;
    if (H5Pget_virtual_count(properties, &sources) < 0) return "its virtual layout is damaged";
    for (std::size_t i = 0; i < sources; ++i) {
      std::array<char, 8> name{};
      if (H5Pget_virtual_filename(properties, i, name.data(), name.size()) < 0 || std::strcmp(name.data(), ".") != 0)
        return "its values lie in other files, which are not read";
    }
  }
  if (layout == H5D_CHUNKED) {
    std::array<hsize_t, H5S_MAX_RANK> chunk{};
    const int rank = H5Pget_chunk(properties, static_cast<int>(chunk.size()), chunk.data());
    for (int i = 0; i < rank; ++i) array.chunk.push_back(chunk[static_cast<std::size_t>(i)]);
  }
  return filter_problem(properties);
}

std::string name_of_object(hid_t object) {
  std::array<char, 1024> name{};
  return H5Iget_name(object, name.data(), name.size()) > 0 ? std::string(name.data()) : std::string();
}

/// Returns the names of the axes: the paths of the dimension scales, or the labels.
std::vector<std::string> dimension_names(hid_t dataset, const std::string& path, std::size_t rank) {
  std::vector<std::string> names;
  if (H5Aexists(dataset, "DIMENSION_LIST") > 0) {
    const Hdf5Handle attribute(H5Aopen(dataset, "DIMENSION_LIST", H5P_DEFAULT), H5Aclose);
    const Hdf5Handle type(H5Aget_type(attribute.get()), H5Tclose), space(H5Aget_space(attribute.get()), H5Sclose);
    const Hdf5Handle base(type && H5Tget_class(type.get()) == H5T_VLEN ? H5Tget_super(type.get()) : H5I_INVALID_HID,
                          H5Tclose);
    const bool references = base && H5Tequal(base.get(), H5T_STD_REF_OBJ) > 0;
    if (references && space && H5Sget_simple_extent_npoints(space.get()) == static_cast<hssize_t>(rank)) {
      std::vector<hvl_t> lists(rank, hvl_t{0, nullptr});
      if (H5Aread(attribute.get(), type.get(), lists.data()) >= 0) {
        for (const hvl_t& list : lists) {
          Hdf5Handle scale;
          if (list.len > 0) scale = Hdf5Handle(H5Rdereference2(dataset, H5P_DEFAULT, H5R_OBJECT, list.p), H5Oclose);
          names.push_back(scale ? name_of_object(scale.get()) : std::string());
        }
        (void)H5Dvlen_reclaim(type.get(), space.get(), H5P_DEFAULT, lists.data());
        return names;
      }
    }
  }
  for (const ArrayAttribute& one : hdf5_attributes(dataset)) {
    if (one.name == "DIMENSION_LABELS" && one.texts.size() == rank) return one.texts;
    if (one.name == "CLASS" && !one.texts.empty() && one.texts[0] == "DIMENSION_SCALE" && rank == 1) names = {path};
  }
  return names;
}

class Hdf5File final : public ArrayFile {
 public:
  Hdf5File(std::unique_ptr<Hdf5Source> source, Hdf5Handle file, std::size_t cache_bytes)
      : source_(std::move(source)), file_(std::move(file)), cache_bytes_(cache_bytes) {}
  ~Hdf5File() override {
    const Hdf5Scope scope;
    open_.clear();
    file_ = {};
  }

  /// Lists the objects. Returns an empty text, or a message.
  std::string list() {
    if (H5Ovisit2(file_.get(), H5_INDEX_NAME, H5_ITER_INC, visit, this, H5O_INFO_BASIC) < 0)
      return hdf5_problem("its list of datasets cannot be read");
    return {};
  }

  const std::vector<ArrayInfo>& arrays() const override { return arrays_; }
  const std::vector<std::string>& groups() const override { return groups_; }

  std::vector<ArrayAttribute> attributes(const std::string& path) override {
    const Hdf5Scope scope;
    const Hdf5Handle object(H5Oopen(file_.get(), path.c_str(), H5P_DEFAULT), H5Oclose);
    return object ? hdf5_attributes(object.get()) : std::vector<ArrayAttribute>();
  }

  std::string read(std::size_t number, std::span<const std::uint64_t> first, std::span<const std::uint64_t> count,
                   std::span<std::byte> to) override {
    const Hdf5Scope scope;
    if (number >= arrays_.size()) return "no such array";
    const ArrayInfo& array = arrays_[number];
    if (!array.problem.empty()) return array.problem;
    if (array.type == NumberType::none) return "it has no numbers";
    std::uint64_t bytes = size_of(array.type) * array.parts;
    if (first.size() != array.shape.size() || count.size() != array.shape.size()) return "its axes differ";
    for (std::size_t i = 0; i < count.size(); ++i) {
      if (first[i] > array.shape[i] || count[i] > array.shape[i] - first[i]) return "the part lies outside";
      if (count[i] > 0 && bytes > std::numeric_limits<std::uint64_t>::max() / count[i]) return "the part is too large";
      bytes *= count[i];
    }
    if (bytes != to.size()) return "the size differs";
    if (bytes == 0) return {};
    const hid_t dataset = dataset_of(number);
    if (dataset < 0) return hdf5_problem("it cannot be opened");
    const Hdf5Handle type(H5Dget_type(dataset), H5Tclose), space(H5Dget_space(dataset), H5Sclose);
    const Hdf5Handle memory_type = hdf5_memory_type(type.get(), array);
    if (!memory_type || H5Tget_size(memory_type.get()) != size_of(array.type) * array.parts)
      return hdf5_problem("its type cannot be converted");
    Hdf5Handle memory(H5Screate(H5S_SCALAR), H5Sclose);
    if (!count.empty()) {
      const std::vector<hsize_t> from(first.begin(), first.end()), size(count.begin(), count.end());
      if (H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, from.data(), nullptr, size.data(), nullptr) < 0)
        return hdf5_problem("the part cannot be chosen");
      memory = {H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), H5Sclose};
    }
    if (source_->bytes.need) {
      const ArrayBox box{{first.begin(), first.end()}, {count.begin(), count.end()}};
      if (!hdf5_need_boxes(*source_, dataset, type.get(), array, {&box, 1})) return "it cannot be received";
    }
    if (H5Dread(dataset, memory_type.get(), memory.get(), space.get(), H5P_DEFAULT, to.data()) < 0)
      return hdf5_problem("it cannot be decoded");
    return {};
  }

  void prepare(std::size_t number, std::span<const ArrayBox> boxes) override {
    const Hdf5Scope scope;
    if (!source_->bytes.need || number >= arrays_.size() || !arrays_[number].problem.empty()) return;
    const ArrayInfo& array = arrays_[number];
    for (const ArrayBox& box : boxes) {
      if (box.first.size() != array.shape.size() || box.count.size() != array.shape.size()) return;
      for (std::size_t i = 0; i < box.first.size(); ++i)
        if (box.count[i] == 0 || box.first[i] >= array.shape[i] || box.count[i] > array.shape[i] - box.first[i]) return;
    }
    const hid_t dataset = dataset_of(number);
    const Hdf5Handle type(dataset >= 0 ? H5Dget_type(dataset) : H5I_INVALID_HID, H5Tclose);
    if (type) (void)hdf5_need_boxes(*source_, dataset, type.get(), array, boxes);
  }

  std::optional<std::uint64_t> written(std::size_t number) override {
    const Hdf5Scope scope;
    if (number >= arrays_.size() || !arrays_[number].problem.empty()) return std::nullopt;
    const auto [place, is_new] = written_.try_emplace(number);
    if (is_new) place->second = count_written(number);
    return place->second;
  }

  std::vector<std::string> texts(std::size_t number) override {
    const Hdf5Scope scope;
    constexpr std::uint64_t kMostBytes = 1 << 20;
    if (number >= arrays_.size() || arrays_[number].shape.size() != 2) return {};
    const std::uint64_t rows = arrays_[number].shape[0], length = arrays_[number].shape[1];
    const hid_t dataset = arrays_[number].problem.empty() ? dataset_of(number) : H5I_INVALID_HID;
    const Hdf5Handle type(dataset >= 0 ? H5Dget_type(dataset) : H5I_INVALID_HID, H5Tclose);
    const bool characters = type && H5Tget_class(type.get()) == H5T_STRING && H5Tis_variable_str(type.get()) == 0 &&
                            H5Tget_size(type.get()) == 1;
    if (!characters || length == 0 || rows > kMostBytes / length) return {};
    std::string bytes(static_cast<std::size_t>(rows * length), '\0');
    if (H5Dread(dataset, type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0) return {};
    std::vector<std::string> all;
    for (std::uint64_t row = 0; row < rows; ++row) {
      const auto text =
          std::string_view(bytes).substr(static_cast<std::size_t>(row * length), static_cast<std::size_t>(length));
      const std::size_t end = text.substr(0, text.find('\0')).find_last_not_of(' ');
      all.emplace_back(text.substr(0, end == std::string_view::npos ? 0 : end + 1));
    }
    return all;
  }

 private:
  static herr_t visit(hid_t file, const char* name, const H5O_info_t* object, void* self) noexcept try {
    return static_cast<Hdf5File*>(self)->add(file, name, *object) ? 0 : 1;
  } catch (...) {
    return -1;
  }

  bool add(hid_t file, const char* name, const H5O_info_t& object) {
    if (std::strcmp(name, ".") == 0) return true;
    const std::string path = std::string("/") + name;
    if (object.type == H5O_TYPE_GROUP) groups_.push_back(path);
    if (object.type == H5O_TYPE_DATASET) arrays_.push_back(describe(file, path));
    return arrays_.size() + groups_.size() < kMostObjects;
  }

  ArrayInfo describe(hid_t file, const std::string& path) const {
    ArrayInfo array;
    array.path = path;
    const Hdf5Handle dataset(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose);
    const Hdf5Handle type(dataset ? H5Dget_type(dataset.get()) : H5I_INVALID_HID, H5Tclose);
    const Hdf5Handle space(dataset ? H5Dget_space(dataset.get()) : H5I_INVALID_HID, H5Sclose);
    const Hdf5Handle properties(dataset ? H5Dget_create_plist(dataset.get()) : H5I_INVALID_HID, H5Pclose);
    if (!type || !space || !properties) {
      array.type_name = "damaged";
      array.problem = hdf5_problem("its description is damaged");
      return array;
    }
    describe_hdf5_type(type.get(), array);
    std::array<hsize_t, H5S_MAX_RANK> sizes{}, maxima{};
    const int rank = H5Sget_simple_extent_dims(space.get(), sizes.data(), maxima.data());
    array.first_grows = rank > 0 && maxima[0] == H5S_UNLIMITED;
    for (int i = 0; i < rank; ++i) array.shape.push_back(sizes[static_cast<std::size_t>(i)]);
    if (H5Sget_simple_extent_type(space.get()) == H5S_NULL) {
      array.shape = {0};
      array.problem = "it is empty";
    }
    if (array.problem.empty()) array.problem = storage_problem(properties.get(), array);
    array.dimensions = dimension_names(dataset.get(), path, array.shape.size());
    return array;
  }

  std::optional<std::uint64_t> count_written(std::size_t number) {
    const ArrayInfo& array = arrays_[number];
    const hid_t dataset = dataset_of(number);
    const Hdf5Handle properties(dataset >= 0 ? H5Dget_create_plist(dataset) : H5I_INVALID_HID, H5Pclose);
    const Hdf5Handle type(dataset >= 0 ? H5Dget_type(dataset) : H5I_INVALID_HID, H5Tclose);
    const Hdf5Handle space(dataset >= 0 ? H5Dget_space(dataset) : H5I_INVALID_HID, H5Sclose);
    if (!properties || !type || !space || H5Tget_size(type.get()) == 0) return std::nullopt;
    const H5D_layout_t layout = H5Pget_layout(properties.get());
    if (layout == H5D_CONTIGUOUS) return H5Dget_storage_size(dataset) / H5Tget_size(type.get());
    hsize_t count = 0;
    if (layout != H5D_CHUNKED || H5Dget_num_chunks(dataset, space.get(), &count) < 0) return std::nullopt;
    for (const std::uint64_t edge : array.chunk) {
      if (edge > 0 && count > std::numeric_limits<std::uint64_t>::max() / edge) return std::nullopt;
      count *= edge;
    }
    return count;
  }

  /// Returns an open dataset. Its cache holds a layer of chunks if they fit.
  hid_t dataset_of(std::size_t number) {
    for (const auto& [open, handle] : open_)
      if (open == number) return handle.get();
    const ArrayInfo& array = arrays_[number];
    const Hdf5Handle access(H5Pcreate(H5P_DATASET_ACCESS), H5Pclose);
    if (!array.chunk.empty() && array.chunk.size() == array.shape.size()) {
      double bytes = static_cast<double>(size_of(array.type)) * array.parts, chunks = 1;
      for (std::size_t i = 0; i < array.chunk.size(); ++i) {
        const auto chunk = static_cast<double>(array.chunk[i]);
        const double along = i + 2 >= array.chunk.size() ? static_cast<double>(array.shape[i]) / chunk + 1 : 1;
        bytes *= chunk * along;
        chunks *= along;
      }
      constexpr double kMostSlots = 1 << 20;
      const auto slots = static_cast<std::size_t>(std::min(chunks * 8 + 521, kMostSlots)) | 1;
      const auto cache = static_cast<std::size_t>(std::min(bytes, static_cast<double>(cache_bytes_)));
      // With a preemption of 1, the library would evict partly read chunks last.
      constexpr double kPreemption = 0;
      (void)H5Pset_chunk_cache(access.get(), slots, cache, kPreemption);
    }
    Hdf5Handle handle(H5Dopen2(file_.get(), array.path.c_str(), access.get()), H5Dclose);
    if (!handle) return H5I_INVALID_HID;
    if (open_.size() >= kMostOpen) open_.erase(open_.begin());
    open_.emplace_back(number, std::move(handle));
    return open_.back().second.get();
  }

  std::unique_ptr<Hdf5Source> source_;
  Hdf5Handle file_;
  std::size_t cache_bytes_;
  std::vector<ArrayInfo> arrays_;
  std::vector<std::string> groups_;
  std::vector<std::pair<std::size_t, Hdf5Handle>> open_;
  std::map<std::size_t, std::optional<std::uint64_t>> written_;  // results of written()
};

}  // namespace

ArrayFileResult open_hdf5_arrays(ArrayBytes bytes, std::size_t cache_bytes) {
  const Hdf5Scope scope;
  auto source = std::make_unique<Hdf5Source>(Hdf5Source{std::move(bytes)});
  Hdf5Handle handle = open_hdf5_bytes(*source);
  if (!handle) return hdf5_problem("the file is damaged or truncated");
  auto file = std::make_shared<Hdf5File>(std::move(source), std::move(handle), cache_bytes);
  if (std::string problem = file->list(); !problem.empty()) return problem;
  return std::shared_ptr<ArrayFile>(std::move(file));
}

}  // namespace gs::app
