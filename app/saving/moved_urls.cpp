#include "app/saving/moved_urls.h"

#include "net/base/reference_policy.h"
#include "net/base/url.h"
#include "vrml/syntax/printer.h"

#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

namespace gs::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestUrl = 4096;  // longer strings are programs or data

net::Url base_of(const std::string& source) {
  net::Url url = net::parse_url(source);
  return url.scheme.empty() ? net::url_of_path(source) : url;
}

fs::path folder_of(const std::string& path) {
  std::error_code error;
  const fs::path folder = fs::absolute(path, error).parent_path();
  const fs::path real = fs::weakly_canonical(folder, error);
  return error ? folder.lexically_normal() : real;
}

// Returns a url list with moved URLs as text, or nullopt if no URL changes.
std::optional<std::string> moved_text(const vrml::MFString& urls, const std::string& source,
                                      const std::string& target) {
  const std::optional<vrml::MFString> moved = moved_list(urls, source, target);
  if (!moved) return std::nullopt;
  static const vrml::SceneGraph kNoScene;
  std::string text;
  if (moved->size() == 1)
    vrml::print_value(text, (*moved)[0], kNoScene);
  else
    vrml::print_value(text, *moved, kNoScene);
  return text;
}

}  // namespace

std::string moved_url(std::string_view url, const std::string& source, const std::string& target) {
  const std::string same(url);
  if (url.size() > kLongestUrl || url.find('\n') != url.npos) return same;
  const net::Url reference = net::parse_url(net::tidy_url(url));
  if (!reference.scheme.empty() || reference.has_authority || reference.path.empty()) return same;
  const net::Url base = base_of(source), absolute = net::resolve(base, reference);
  if (!net::has_scheme(absolute.text(), "file"))
    return net::has_scheme(absolute.text(), "data") ? same : absolute.text();
  std::error_code error;
  const std::string path = net::path_of_url(absolute);
  if (reference.path.starts_with('/') || !fs::exists(path, error)) return same;
  const fs::path real = fs::weakly_canonical(path, error);
  const fs::path way = (error ? fs::path(path) : real).lexically_relative(folder_of(target));
  if (way.empty()) return same;
  std::string moved = net::reference_of_path(way.generic_string());
  if (absolute.has_query) moved += "?" + absolute.query;
  if (absolute.has_fragment) moved += "#" + absolute.fragment;
  return moved;
}

std::optional<vrml::MFString> moved_list(const vrml::MFString& urls, const std::string& source,
                                         const std::string& target) {
  vrml::MFString moved;
  bool differs = false;
  for (const vrml::String& url : urls) {
    std::string one = moved_url(url.view(), source, target);
    differs = differs || one != url.view();
    moved.push_back(vrml::String(one));
  }
  return differs ? std::optional(std::move(moved)) : std::nullopt;
}

bool have_one_folder(const std::string& source, const std::string& target) {
  const net::Url base = base_of(source);
  return net::has_scheme(base.text(), "file") && folder_of(net::path_of_url(base)) == folder_of(target);
}

std::vector<vrml::TextEdit> moved_urls(const vrml::SceneGraph& scene, const std::string& source,
                                       const std::string& target) {
  std::vector<vrml::TextEdit> edits;
  if (have_one_folder(source, target)) return edits;
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i) {
    const vrml::NodeId id = scene.nodes().id_at(i);
    if (!scene.contains(id) || scene.node(id).instance != 0) continue;  // copies for PROTO instances have no text
    const vrml::Node& node = scene.node(id);
    if (node.text != &scene) continue;
    for (const vrml::InterfaceDeclaration* field : node.type->url_fields())
      if (node.values[field->slot] != node.type->defaults[field->slot])
        if (auto list = moved_text(std::get<vrml::MFString>(node.values[field->slot]), source, target))
          edits.push_back({node.location, node.type->name, field->name, std::move(*list)});
  }
  for (const auto& type : scene.types()) {
    if (type->stands_in) continue;
    if (type->kind == vrml::NodeType::Kind::external_prototype)
      if (auto list = moved_text(type->url, source, target))
        edits.push_back({type->location, type->name, {}, std::move(*list)});
    if (type->kind != vrml::NodeType::Kind::prototype) continue;
    for (const vrml::InterfaceDeclaration* field : type->url_fields())
      if (auto list = moved_text(std::get<vrml::MFString>(field->initial), source, target))
        edits.push_back({type->location, type->name, field->name, std::move(*list)});
  }
  return edits;
}

}  // namespace gs::app
