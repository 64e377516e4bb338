#include "app/references.h"

#include "app/cloud_reader.h"
#include "app/content_types.h"
#include "app/scene_reader.h"
#include "vrml/prototype.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <memory>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <variant>

namespace gs::app {
namespace {

namespace fs = std::filesystem;
using vrml::NodeId;
using vrml::Severity;

constexpr std::size_t kMaxChain = 32;                     // Inlines and EXTERNPROTOs inside each other
constexpr std::size_t kMaxFiles = 20'000;                 // of all kinds, one world
constexpr std::size_t kMaxCopied = std::size_t{1} << 26;  // vectors of nodes that change what a stream says

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return text;
}

// The path of an existing file that differs from `path` in upper and lower case only; empty for none.
std::string find_ignoring_case(const fs::path& path) {
  std::error_code error;
  fs::path found = path.is_absolute() ? path.root_path() : fs::path(".");
  for (const fs::path& part : path.relative_path()) {
    fs::path next = found / part;
    if (!fs::exists(next, error)) {
      const std::string wanted = lower_case(part.string());
      next.clear();
      for (fs::directory_iterator entry(found, error), end; !error && entry != end; entry.increment(error))
        if (lower_case(entry->path().filename().string()) == wanted) next = entry->path();
      if (next.empty()) return {};
    }
    found = next;
  }
  return found.string();
}

class ReferenceLoader {
 public:
  ReferenceLoader(References found, vrml::Diagnostics& diagnostics, const LoadLimit& limit)
      : images_(found.images), clouds_(found.clouds), diagnostics_(diagnostics), limit_(limit) {}

  // `chain`: the files that this scene lies in, outermost first.
  void load(vrml::SceneGraph& scene, const std::vector<std::string>& chain) {
    std::vector<net::Url> bases{net::url_of_path(chain.back())};
    load_external_prototypes(scene, chain, bases);
    const auto count = static_cast<std::uint32_t>(scene.node_count());
    for (std::uint32_t i = 1; i <= count; ++i) {
      const NodeId id = scene.id_at(i);
      const vrml::Node& node = scene.node(id);
      if (node.in_prototype_body) continue;
      if (node.type->prototype || node.type->kind == vrml::NodeType::Kind::external_prototype) {
        if (node.type->name == "QNV") replace_fallback(scene, id, bases);
        continue;
      }
      if (node.type->kind != vrml::NodeType::Kind::built_in) continue;
      if (node.type->name == "Inline") load_inline(scene, id, chain, bases);
      if (node.type->name == "ImageTexture") load_image(scene, id, bases);
      if (node.type->name == "QNV") load_cloud(scene, id, bases);
    }
  }

 private:
  struct Found {
    net::MappedFile file;
    std::string path;
    std::string fragment;
  };

  void report(Severity severity, const vrml::SceneGraph& scene, vrml::SourceLocation location, std::string message) {
    diagnostics_.add({severity, scene.file_name(), location, std::move(message)});
  }

  bool out_of_time(const vrml::SceneGraph& scene) {
    if (stopped_) return true;
    stopped_ = limit_.over() || files_ >= kMaxFiles;
    if (stopped_)
      report(Severity::error, scene, {},
             files_ >= kMaxFiles
                 ? "refers to more than " + std::to_string(kMaxFiles) + " files; the rest is left out"
                 : "the time for loading is over; Inlines, textures and EXTERNPROTOs that are missing are left out");
    return stopped_;
  }

  // The first url of the list that is there, seen from each base in turn.
  std::optional<Found> find(const vrml::MFString& urls, const std::vector<net::Url>& bases) {
    for (const vrml::SFString& url : urls) {
      const net::Url parsed = net::parse_url(net::tidy_url(url.view()));
      for (const net::Url& base : bases) {
        Found found;
        if (auto file = open_reference(base, url.view(), &found.path)) {
          ++files_;
          found.file = std::move(*file);
          found.fragment = parsed.fragment;
          return found;
        }
      }
    }
    return std::nullopt;
  }

  static std::string missing(std::string_view what, const vrml::MFString& urls) {
    if (urls.empty()) return std::string(what) + " has no url";
    std::string text = std::string(what) + ": cannot find '" + std::string(urls.front().view().substr(0, 200)) + "'";
    if (urls.size() > 1) text += " or the " + std::to_string(urls.size() - 1) + " others of its url list";
    const std::string scheme = net::parse_url(net::tidy_url(urls.front().view())).scheme;
    if (!scheme.empty() && scheme != "file") text += " (only local files are loaded)";
    return text;
  }

  void load_external_prototypes(vrml::SceneGraph& scene, const std::vector<std::string>& chain,
                                std::vector<net::Url>& bases) {
    std::unordered_set<const vrml::NodeType*> used;
    for (std::uint32_t i = 1; i <= scene.node_count(); ++i) used.insert(scene.node(scene.id_at(i)).type);
    std::unordered_map<std::string, vrml::SceneGraph*> libraries;
    for (const std::unique_ptr<vrml::NodeType>& type : scene.types()) {
      if (type->kind != vrml::NodeType::Kind::external_prototype || type->prototype || !used.contains(type.get()))
        continue;
      if (out_of_time(scene)) return;
      auto found = find(type->url, {bases.front()});
      if (!found) {
        if (type->name != "QNV") report(Severity::warning, scene, {}, missing("EXTERNPROTO " + type->name, type->url));
        continue;
      }
      if (std::find(chain.begin(), chain.end(), found->path) != chain.end() || chain.size() >= kMaxChain) {
        report(Severity::error, scene, {},
               "EXTERNPROTO " + type->name + " leads back to " + found->path + "; left out");
        continue;
      }
      vrml::SceneGraph*& library = libraries[found->path];
      if (!library) {
        SceneRead read = read_scene(found->path, found->file.bytes(), diagnostics_, limit_);
        if (!read.scene) read.scene = std::make_unique<vrml::SceneGraph>(found->path);
        std::vector<std::string> inner = chain;
        inner.push_back(found->path);
        std::vector<net::Url> inner_bases{net::url_of_path(found->path)};
        load_external_prototypes(*read.scene, inner, inner_bases);
        library = &scene.attach_library(std::move(read.scene));
        bases.push_back(inner_bases.front());
      }
      const vrml::NodeType* source = vrml::find_prototype(*library, found->fragment);
      if (!source || !source->prototype) {
        report(Severity::error, scene, {},
               found->path + " declares no PROTO" + (found->fragment.empty() ? "" : " '" + found->fragment + "'") +
                   " for EXTERNPROTO " + type->name);
      } else if (!vrml::resolve_external(scene, *type, *source)) {
        report(Severity::error, scene, {}, "EXTERNPROTO instances make more nodes than the limit; the rest stay empty");
      }
    }
  }

  void load_inline(vrml::SceneGraph& scene, NodeId id, const std::vector<std::string>& chain,
                   const std::vector<net::Url>& bases) {
    if (scene.inlined(id) || out_of_time(scene)) return;
    const auto& urls = scene.get<vrml::MFString>(id, "url");
    if (urls.empty()) return;
    const vrml::SourceLocation location = scene.node(id).location;
    auto found = find(urls, bases);
    if (!found) {
      report(Severity::warning, scene, location, missing("Inline", urls));
      return;
    }
    if (std::find(chain.begin(), chain.end(), found->path) != chain.end() || chain.size() >= kMaxChain) {
      report(Severity::error, scene, location, "Inline leads back to " + found->path + "; left out");
      return;
    }
    SceneRead read = read_scene(found->path, found->file.bytes(), diagnostics_, limit_);
    if (!read.scene) return;
    std::vector<std::string> inner = chain;
    inner.push_back(found->path);
    clouds_.insert(read.clouds.begin(), read.clouds.end());
    load(*read.scene, inner);
    scene.attach_inline(id, std::move(read.scene));
  }

  void load_image(vrml::SceneGraph& scene, NodeId id, const std::vector<net::Url>& bases) {
    const auto& urls = scene.get<vrml::MFString>(id, "url");
    if (urls.empty() || out_of_time(scene)) return;
    const vrml::SourceLocation location = scene.node(id).location;
    const auto keep = [&](std::shared_ptr<const render::Image> image) {
      if (image) images_[&scene.node(id)] = std::move(image);
    };
    for (const vrml::SFString& url : urls) {
      if (!url.view().starts_with("data:")) continue;
      const auto data = data_of_url(url.view());
      if (!data) {
        report(Severity::warning, scene, location, "ImageTexture: malformed data: URL");
        continue;
      }
      return keep(decode(*data, scene, location, "data: URL"));
    }
    const auto found = find(urls, bases);
    if (!found) {
      report(Severity::warning, scene, location, missing("ImageTexture", urls));
      return;
    }
    const auto known = by_path_.find(found->path);
    if (known != by_path_.end()) return keep(known->second);
    keep(by_path_[found->path] = decode(found->file.bytes(), scene, location, found->path));
  }

  // From its own records, else from the first file of its url list; the node's transfer function goes before the
  // stream's.
  void load_cloud(vrml::SceneGraph& scene, NodeId id, const std::vector<net::Url>& bases) {
    const vrml::Node* node = &scene.node(id);
    if (clouds_.contains(node) || out_of_time(scene)) return;
    if (!scene.get<vrml::MFInt32>(id, "vectors").empty()) {
      auto made = inline_cloud(scene, id);
      if (const auto* problem = std::get_if<std::string>(&made))
        report(Severity::warning, scene, node->location, "QNV: " + *problem);
      else
        clouds_[node] = std::make_shared<const qnv::Cloud>(std::move(std::get<qnv::Cloud>(made)));
      return;
    }
    const auto& urls = scene.get<vrml::MFString>(id, "url");
    if (urls.empty()) return;
    const auto found = find(urls, bases);
    if (!found) {
      report(Severity::warning, scene, node->location, missing("QNV", urls));
      return;
    }
    const auto [known, is_new] = clouds_by_path_.try_emplace(found->path);
    if (is_new) known->second = read_vectors(*found, scene, node->location);
    if (!known->second) return;
    auto transfer = transfer_of(scene.get<vrml::MFFloat>(id, "transfer"));
    clouds_[node] = known->second;
    if (transfer.empty()) return;
    if (known->second->size() > kMaxCopied - copied_) {
      report(Severity::warning, scene, node->location, "QNV: too many vectors with a transfer of their own; left out");
      return;
    }
    copied_ += known->second->size();
    qnv::Cloud own = *known->second;
    own.description.transfer = std::move(transfer);
    clouds_[node] = std::make_shared<const qnv::Cloud>(std::move(own));
  }

  // A PROTO of the name of our own node is how a world looks in browsers that do not know it. Where its vectors are
  // there, they are shown in the place of its body.
  void replace_fallback(vrml::SceneGraph& scene, NodeId id, const std::vector<net::Url>& bases) {
    vrml::Node& instance = scene.node(id);
    const vrml::NodeType& native = *vrml::built_in_node_type("QNV");
    const NodeId made = scene.create(native, instance.location);
    if (!made) return;
    vrml::Node& node = scene.node(made);
    for (const vrml::InterfaceDeclaration& declaration : native.interfaces) {
      const vrml::InterfaceDeclaration* own = instance.type->find_field(declaration.name);
      if (declaration.slot >= 0 && own && own->type == declaration.type)
        node.values[declaration.slot] = instance.values[own->slot];
    }
    load_cloud(scene, made, bases);
    if (!clouds_.contains(&node)) return;
    instance.expansion = {};
    instance.expansion.push_back(made);
  }

  std::shared_ptr<const qnv::Cloud> read_vectors(const Found& found, const vrml::SceneGraph& scene,
                                                 vrml::SourceLocation location) {
    const auto bytes = found.file.bytes();
    const ContentType& type = content_type_of(found.path, first_bytes(bytes));
    if (!type.is_cloud()) {
      report(Severity::warning, scene, location,
             "QNV: " + found.path + " is " + std::string(type.name) + "; expected a QNV stream");
      return nullptr;
    }
    auto cloud = read_cloud(type, {found.path, bytes}, diagnostics_, limit_);
    return cloud ? std::make_shared<const qnv::Cloud>(std::move(*cloud)) : nullptr;
  }

  std::shared_ptr<const render::Image> decode(std::span<const std::byte> bytes, const vrml::SceneGraph& scene,
                                              vrml::SourceLocation location, const std::string& name) {
    auto decoded = render::decode_image(bytes);
    if (auto* problem = std::get_if<render::ImageError>(&decoded)) {
      report(Severity::warning, scene, location, "ImageTexture " + name + ": " + problem->message);
      return nullptr;
    }
    return std::make_shared<const render::Image>(std::move(std::get<render::Image>(decoded)));
  }

  render::Images& images_;
  render::Clouds& clouds_;
  vrml::Diagnostics& diagnostics_;
  LoadLimit limit_;
  std::unordered_map<std::string, std::shared_ptr<const render::Image>> by_path_;
  std::unordered_map<std::string, std::shared_ptr<const qnv::Cloud>> clouds_by_path_;
  std::size_t files_ = 0, copied_ = 0;
  bool stopped_ = false;
};

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;
  return c == '/' || c == '_' ? 63 : -1;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

}  // namespace

std::optional<net::MappedFile> open_reference(const net::Url& base, std::string_view reference, std::string* path) {
  const net::Url url = net::resolve(base, net::parse_url(net::tidy_url(reference)));
  std::string file_path = net::path_of_url(url);
  if (file_path.empty()) return std::nullopt;
  auto opened = net::map_file(file_path);
  if (std::holds_alternative<net::FileError>(opened)) {
    file_path = find_ignoring_case(file_path);
    if (file_path.empty()) return std::nullopt;
    opened = net::map_file(file_path);
  }
  auto* file = std::get_if<net::MappedFile>(&opened);
  if (!file) return std::nullopt;
  if (path) *path = file_path;
  return std::move(*file);
}

std::optional<std::vector<std::byte>> data_of_url(std::string_view url) {
  const std::size_t comma = url.find(',');
  if (!url.starts_with("data:") || comma == std::string_view::npos) return std::nullopt;
  const bool base64 = url.substr(0, comma).ends_with(";base64");
  const std::string_view data = url.substr(comma + 1);
  std::vector<std::byte> bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    char c = data[i];
    if (c == '%') {
      if (i + 2 >= data.size() || hex_digit(data[i + 1]) < 0 || hex_digit(data[i + 2]) < 0) return std::nullopt;
      c = static_cast<char>(hex_digit(data[i + 1]) * 16 + hex_digit(data[i + 2]));
      i += 2;
    }
    if (!base64) {
      bytes.push_back(static_cast<std::byte>(c));
      continue;
    }
    if (c == '=' || c == ' ' || c == '\n' || c == '\r' || c == '\t') continue;
    if (base64_digit(c) < 0) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(base64_digit(c));
    if (++count == 4) {
      for (const int shift : {16, 8, 0}) bytes.push_back(static_cast<std::byte>(bits >> shift & 0xff));
      bits = 0;
      count = 0;
    }
  }
  if (count == 1) return std::nullopt;
  if (count >= 2) bytes.push_back(static_cast<std::byte>(bits >> (6 * count - 8) & 0xff));
  if (count == 3) bytes.push_back(static_cast<std::byte>(bits >> 2 & 0xff));
  return bytes;
}

void load_references(vrml::SceneGraph& scene, const std::string& path, References found, vrml::Diagnostics& diagnostics,
                     const LoadLimit& limit) {
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error);
  ReferenceLoader(found, diagnostics, limit).load(scene, {error ? path : absolute.lexically_normal().string()});
}

}  // namespace gs::app
