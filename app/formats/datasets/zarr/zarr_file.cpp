#include "app/formats/datasets/zarr/zarr_file.h"

#include "net/base/reference_policy.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <deque>
#include <optional>
#include <set>
#include <utility>

namespace gs::app {
namespace {

using nlohmann::json;

constexpr std::size_t kMostZarrNodes = 10'000;  // groups and arrays of a container
constexpr std::size_t kMostZarrDepth = 16;
constexpr std::size_t kMostZarrAttributes = 256, kMostZarrValues = 65'536;  // of a node; of an attribute

/// Returns the path without "." parts and empty ones, or nullopt if it leaves the container.
std::optional<std::string> tidy_path(std::string_view path) {
  std::string result;
  while (!path.empty()) {
    const std::size_t end = std::min(path.find('/'), path.size());
    const std::string_view part = path.substr(0, end);
    path.remove_prefix(std::min(end + 1, path.size()));
    if (part.empty() || part == ".") continue;
    if (part == "..") return std::nullopt;
    result += (result.empty() ? "" : "/") + std::string(part);
  }
  return result;
}

std::string zarr_path(const std::string& group, std::string_view name) {
  return group.empty() ? std::string(name) : group + "/" + std::string(name);
}

/// Returns an attribute, or nullopt for values that are neither numbers nor texts.
std::optional<ArrayAttribute> zarr_attribute(const std::string& name, const json& value) {
  ArrayAttribute attribute{name, {}, {}};
  const auto add = [&](const json& one) {
    if (one.is_boolean())
      attribute.numbers.push_back(one.get<bool>() ? 1 : 0);
    else if (one.is_number())
      attribute.numbers.push_back(one.get<double>());
    else if (one.is_string())
      attribute.texts.push_back(one.get<std::string>());
    else
      return false;
    return true;
  };
  if (!value.is_array()) return add(value) ? std::optional(attribute) : std::nullopt;
  if (value.size() > kMostZarrValues) return std::nullopt;
  for (const json& one : value)
    if (!add(one)) return std::nullopt;
  return attribute;
}

NumberType zarr_number_type(StoredType type) {
  static constexpr NumberType kTypes[] = {NumberType::u8,  NumberType::i8,  NumberType::u16, NumberType::i16,
                                          NumberType::u32, NumberType::i32, NumberType::f32, NumberType::f64,
                                          NumberType::u64, NumberType::i64};
  return kTypes[static_cast<std::size_t>(type)];
}

/// Group or array, as its metadata files describe it.
struct ZarrNode {
  json array;       // null for a group
  json attributes;  // an object or null
  json other;       // rest of the metadata of a group
  int version = 0;  // 2 or 3 for Zarr, 0 for N5
};

}  // namespace

struct ZarrFile::Array {
  std::unique_ptr<ZarrReader> reader;  // null if it cannot be read
};

/// Finder of the nodes of a container.
class ZarrFile::Finder {
 public:
  explicit Finder(ZarrFile& file) : file_(file) {}

  /// Returns a message if there is no container.
  std::string find() {
    const auto root = read_nodes({{"", NodeKind::any}});
    if (root.front().index() == 1) return std::get<std::string>(root.front());
    version_ = std::get<ZarrNode>(root.front()).version;
    add("", std::get<ZarrNode>(root.front()));
    while (!waiting_.empty() && nodes_ < kMostZarrNodes) {
      std::vector<Waiting> nodes;
      constexpr std::size_t kAtOnce = 16;
      while (!waiting_.empty() && nodes.size() < kAtOnce) {
        nodes.push_back(std::move(waiting_.front()));
        waiting_.pop_front();
      }
      const auto found = read_nodes(nodes);
      for (std::size_t i = 0; i < nodes.size(); ++i)
        if (const auto* const node = std::get_if<ZarrNode>(&found[i])) add(nodes[i].path, *node);
    }
    return {};
  }

 private:
  using Found = std::variant<ZarrNode, std::string>;
  /// Kind of a node as stated by other nodes: a level of an image, or a group of labels.
  enum class NodeKind : std::uint8_t { any, level, labels };
  struct Waiting {
    std::string path;
    NodeKind kind = NodeKind::any;
  };

  /// Returns true if a node may have the metadata file with index `file` in kZarrMetadataFiles. For nodes on servers,
  /// leaves out files of version 2 that the kind of the node makes unnecessary.
  [[nodiscard]] bool may_have(NodeKind kind, std::size_t file) const {
    static constexpr int kVersions[] = {3, 2, 2, 2, 2, 0};
    constexpr std::size_t kAttributes = 2, kArray = 4;
    if (version_ && *version_ != kVersions[file]) return false;
    if (version_ != 2 || !file_.place_.remote || kind == NodeKind::any) return true;
    return file == (kind == NodeKind::level ? kArray : kAttributes);
  }

  /// Reads the metadata files of nodes, all at once.
  std::vector<Found> read_nodes(const std::vector<Waiting>& nodes) {
    constexpr std::size_t kFiles = std::size(kZarrMetadataFiles);
    std::vector<FileRequest> requests;
    for (const auto& [path, kind] : nodes)
      for (std::size_t i = 0; i < kFiles; ++i)
        if (may_have(kind, i)) requests.push_back({net::reference_of_path(zarr_path(path, kZarrMetadataFiles[i]))});
    std::vector<FileResult> results = file_.place_.read(requests);
    results.resize(requests.size(), std::string("its metadata were not read"));
    std::vector<Found> found;
    auto next = results.begin();
    for (const auto& [path, kind] : nodes) {
      std::vector<FileResult> files(kFiles, NoFile());
      for (std::size_t i = 0; i < kFiles; ++i)
        if (may_have(kind, i)) files[i] = std::move(*next++);
      found.push_back(node_of(path, files));
    }
    return found;
  }

  Found node_of(const std::string& path, std::span<const FileResult> files) {
    json parsed[std::size(kZarrMetadataFiles)];
    std::string problem;
    for (std::size_t i = 0; i < files.size(); ++i) {
      if (const auto* const bytes = std::get_if<SharedBytes>(&files[i])) {
        Share share(file_.place_.budget, Resource::volumes);
        constexpr std::size_t kPerByte = 16;  // memory of JSON values
        if (!share.grow(bytes->bytes.size() * kPerByte)) return file_.place_.budget->refusal(Resource::volumes);
        parsed[i] = zarr_json(bytes->bytes);
        if (!parsed[i].is_object())
          return zarr_path(path, kZarrMetadataFiles[i]) + ": not JSON; expected the metadata of a group or array";
      } else if (const auto* const message = std::get_if<std::string>(&files[i])) {
        problem = *message;
      }
    }
    const auto& [v3, consolidated, attributes, group, array, n5] = parsed;
    ZarrNode node;
    if (v3.is_object()) {
      node.version = 3;
      node.attributes = zarr_member(v3, "attributes");
      if (zarr_member(v3, "node_type") == "array")
        node.array = v3;
      else if (zarr_member(v3, "node_type") == "group")
        node.other = zarr_member(zarr_member(v3, "consolidated_metadata"), "metadata");
      else
        return zarr_path(path, "zarr.json") + ": its node_type is neither \"group\" nor \"array\"";
      return node;
    }
    node.version = 2;
    node.attributes = attributes;
    if (array.is_object()) {
      node.array = array;
      return node;
    }
    if (group.is_object() || consolidated.is_object() || attributes.is_object()) {
      node.other = zarr_member(consolidated, "metadata");
      return node;
    }
    if (n5.is_object()) {
      node.version = 0;
      node.attributes = n5;
      if (n5.contains("dimensions")) node.array = n5;
      return node;
    }
    if (!problem.empty()) return problem;
    return std::string(
        "no metadata of Zarr or N5 here; expected one of zarr.json, .zgroup, .zarray, .zattrs, "
        "attributes.json");
  }

  void add(const std::string& path, const ZarrNode& node) {
    if (!seen_.insert(path).second || ++nodes_ > kMostZarrNodes) return;
    std::vector<ArrayAttribute>& attributes = file_.attributes_["/" + path];
    if (node.attributes.is_object())
      for (const auto& [name, value] : node.attributes.items())
        if (attributes.size() < kMostZarrAttributes)
          if (auto one = zarr_attribute(name, value)) attributes.push_back(std::move(*one));
    if (!node.array.is_null()) return add_array(path, node);
    if (!path.empty()) file_.groups_.push_back("/" + path);
    bool listed = add_consolidated(path, node);
    for (ZarrImage& image : zarr_images(node.attributes, "/" + path)) {
      for (ZarrLevel& level : image.levels) {
        const auto place = tidy_path(zarr_path(path, level.path));
        level.path = place ? "/" + *place : std::string();
        if (place && !seen_.contains(*place)) waiting_.push_back({*place, NodeKind::level});
      }
      std::erase_if(image.levels, [](const ZarrLevel& level) { return level.path.empty(); });
      if (image.levels.empty()) continue;
      file_.images_.push_back(std::move(image));
      // Consolidated metadata lists all nodes, including the labels.
      if (!listed) waiting_.push_back({zarr_path(path, "labels"), NodeKind::labels});
      listed = true;
    }
    listed = add_named(path, node) || listed;
    if (!listed || !file_.place_.remote) add_listed(path);
  }

  /// Adds the nodes of consolidated metadata. Returns false if there are none.
  bool add_consolidated(const std::string& path, const ZarrNode& node) {
    if (!node.other.is_object() || node.other.empty()) return false;
    std::map<std::string, ZarrNode> found;
    for (const auto& [key, value] : node.other.items()) {
      if (found.size() > kMostZarrNodes) break;
      const auto place = tidy_path(key);
      if (!place) continue;
      if (node.version == 3) {
        ZarrNode& one = found[*place];
        one.version = 3;
        one.attributes = zarr_member(value, "attributes");
        if (zarr_member(value, "node_type") == "array") one.array = value;
        continue;
      }
      const std::size_t slash = place->rfind('/');
      const std::string name = place->substr(slash == std::string::npos ? 0 : slash + 1);
      ZarrNode& one = found[slash == std::string::npos ? std::string() : place->substr(0, slash)];
      one.version = 2;
      if (name == ".zarray") one.array = value;
      if (name == ".zattrs") one.attributes = value;
    }
    found.erase(std::string());
    for (const auto& [name, one] : found) add(zarr_path(path, name), one);
    return true;
  }

  /// Adds nodes that the attributes name: labels, the images of a file that was converted, the wells of a plate.
  bool add_named(const std::string& path, const ZarrNode& node) {
    const json& ome =
        zarr_member(node.attributes, "ome").is_object() ? zarr_member(node.attributes, "ome") : node.attributes;
    bool named = false;
    const auto add_all = [&](const json& list, const char* member) {
      if (!list.is_array()) return;
      for (const json& one : list) {
        const json& name = member ? zarr_member(one, member) : one;
        if (!name.is_string() || waiting_.size() > kMostZarrNodes) continue;
        if (const auto place = tidy_path(zarr_path(path, name.get<std::string>()))) waiting_.push_back({*place});
        named = true;
      }
    };
    add_all(zarr_member(ome, "labels"), nullptr);
    add_all(zarr_member(ome, "series"), nullptr);
    add_all(zarr_member(zarr_member(ome, "plate"), "wells"), "path");
    add_all(zarr_member(zarr_member(ome, "well"), "images"), "path");
    if (zarr_member(ome, "bioformats2raw.layout").is_number()) {
      waiting_.push_back({zarr_path(path, "0")});
      named = true;
    }
    return named;
  }

  void add_listed(const std::string& path) {
    if (!file_.place_.list || static_cast<std::size_t>(std::ranges::count(path, '/')) >= kMostZarrDepth) return;
    const auto names = file_.place_.list(net::reference_of_path(path.empty() ? "." : path));
    if (!names) return;
    std::vector<std::string> sorted;
    for (const std::string& name : *names)
      if (!name.empty() && name[0] != '.' && !name.ends_with(".json")) sorted.push_back(name);
    std::ranges::sort(sorted);
    for (const std::string& name : sorted)
      if (waiting_.size() < kMostZarrNodes) waiting_.push_back({zarr_path(path, name)});
  }

  void add_array(const std::string& path, const ZarrNode& node) {
    ArrayInfo info;
    info.path = "/" + path;
    ZarrArrayResult made = node.version == 3   ? zarr_array_of_v3(node.array)
                           : node.version == 2 ? zarr_array_of_v2(node.array)
                                               : zarr_array_of_n5(node.array);
    Array array;
    if (auto* const problem = std::get_if<std::string>(&made)) {
      info.problem = std::move(*problem);
      const json& shape = zarr_member(node.array, node.version == 0 ? "dimensions" : "shape");
      if (shape.is_array() && shape.size() <= kMostZarrDimensions)
        for (const json& one : shape) info.shape.push_back(one.is_number_unsigned() ? one.get<std::uint64_t>() : 0);
      const json& type = zarr_member(node.array, node.version == 3   ? "data_type"
                                                 : node.version == 2 ? "dtype"
                                                                     : "dataType");
      info.type_name = type.is_string() ? type.get<std::string>().substr(0, 64) : "structure";
    } else {
      ZarrArray& known = std::get<ZarrArray>(made);
      info.shape = known.shape;
      info.chunk = known.chunk;
      info.type = zarr_number_type(known.type.stored);
      info.parts = static_cast<std::uint32_t>(known.type.components);
      if (info.parts == 2) info.part_names = {"r", "i"};
      info.type_name = known.type_name;
      info.dimensions = known.dimensions;
      // Convention of xarray for version 2.
      if (const json& names = zarr_member(node.attributes, "_ARRAY_DIMENSIONS");
          info.dimensions.empty() && names.is_array() && names.size() == known.shape.size())
        for (const json& name : names) info.dimensions.push_back(name.is_string() ? name.get<std::string>() : "");
      array.reader = std::make_unique<ZarrReader>(path.empty() ? "" : net::reference_of_path(path) + "/",
                                                  std::move(known), file_.place_.read, file_.place_.budget);
    }
    file_.infos_.push_back(std::move(info));
    file_.arrays_.push_back(std::move(array));
  }

  ZarrFile& file_;
  std::deque<Waiting> waiting_;
  std::set<std::string> seen_;
  std::optional<int> version_;  // of the root
  std::size_t nodes_ = 0;
};

ZarrFile::ZarrFile(ZarrPlace place) : place_(std::move(place)) {}
ZarrFile::~ZarrFile() = default;

std::variant<std::shared_ptr<ZarrFile>, std::string> ZarrFile::open(ZarrPlace place) {
  const std::shared_ptr<ZarrFile> file(new ZarrFile(std::move(place)));
  if (std::string problem = Finder(*file).find(); !problem.empty()) return problem;
  // Images without an array that can be read have nothing to show.
  for (ZarrImage& image : file->images_)
    std::erase_if(image.levels, [&](const ZarrLevel& level) {
      const auto found = std::ranges::find(file->infos_, level.path, &ArrayInfo::path);
      return found == file->infos_.end() || found->shape.size() != image.axes.size();
    });
  std::erase_if(file->images_, [](const ZarrImage& image) { return image.levels.empty(); });
  if (file->infos_.empty() && (!file->place_.list || file->place_.remote))
    return std::string("the server does not list this group; name one of its arrays, as in data.zarr/temperature");
  return file;
}

std::vector<ArrayAttribute> ZarrFile::attributes(const std::string& path) {
  const auto found = attributes_.find(path);
  return found == attributes_.end() ? std::vector<ArrayAttribute>() : found->second;
}

std::string ZarrFile::read(std::size_t array, std::span<const std::uint64_t> first,
                           std::span<const std::uint64_t> count, std::span<std::byte> to) {
  if (array >= arrays_.size()) return "no such array";
  if (!arrays_[array].reader) return infos_[array].problem;
  if (arrays_[array].reader->read(first, count, to)) return {};
  return place_.budget->stopped() ? std::string("it was stopped")
                                  : "a box of it takes " + place_.budget->refusal(Resource::volumes);
}

std::string ZarrFile::trouble() const {
  std::string all;
  for (std::size_t i = 0; i < arrays_.size(); ++i)
    if (const std::string one = arrays_[i].reader ? arrays_[i].reader->trouble() : std::string(); !one.empty())
      all += (all.empty() ? "" : "; ") + infos_[i].path + ": " + one;
  return all;
}

}  // namespace gs::app
