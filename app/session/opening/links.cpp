#include "app/session/opening/links.h"

#include "app/session/documents/link_file.h"

#include "app/base/local_file.h"
#include "app/formats/content_types.h"
#include "net/base/schemes.h"
#include "net/base/url.h"

#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <utility>

extern char** environ;

namespace gs::app {
namespace {

// Returns the base URL for relative URLs in a file: the URL of that file (VRML97 4.5.3).
net::Url base_of(const std::string& file) {
  net::Url asked = net::parse_url(file);
  if (!asked.scheme.empty() && net::find_scheme(asked.scheme)) return asked;
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(file, error);
  return net::url_of_path(error ? file : absolute.lexically_normal().string());
}

// Returns the reason why a document must not link to an ssh: URL: the user would open it, with rights on that account.
std::optional<net::ReferenceRefusal> refuse_account(const net::Url& document, const net::Url& url) {
  net::ReferencePolicy policy;
  if (document.scheme == "ssh") policy.allow_ssh(document);
  return policy.refuse({document.text()}, url);
}

// Returns true for URLs that a web browser should open: pages, images and movies.
bool is_for_browser(const net::Url& url) {
  if (url.scheme == "mailto") return true;
  if (url.scheme != "http" && url.scheme != "https") return false;
  return !content_type_by_name(url.path.substr(url.path.rfind('/') + 1));
}

}  // namespace

GivenPlace given_place(const std::string& path_or_url) {
  if (const auto link = scene_link_of(path_or_url)) {
    if (const auto* problem = std::get_if<std::string>(&*link)) return {path_or_url, {}, 0, *problem};
    const auto& known = std::get<SceneLink>(*link);
    return {known.url, known.viewpoint, known.budget, {}};
  }
  if (view_number(path_or_url) > 1) return {path_or_url, {}, 0, {}};
  const std::size_t mark = path_or_url.rfind('#');
  if (mark == std::string::npos) return {path_or_url, {}, 0, {}};
  GivenPlace parts{path_or_url.substr(0, mark), path_or_url.substr(mark + 1), 0, {}};
  net::Url url = net::parse_url(path_or_url);
  if (!url.scheme.empty() && net::find_scheme(url.scheme))
    return url.scheme == "data" ? GivenPlace{path_or_url, {}, 0, {}} : parts;
  std::error_code error;
  return std::filesystem::exists(path_or_url, error) || !std::filesystem::exists(parts.target, error)
             ? GivenPlace{path_or_url, {}, 0, {}}
             : parts;
}

Link link_of(const vrml::SceneGraph& scene, vrml::NodeId anchor) {
  const vrml::InterfaceDeclaration* url_field = scene.node(anchor).type->find_field("url");
  std::vector<std::string> urls, parameters;
  for (const vrml::SFString& url : scene.get<vrml::MFString>(anchor, "url")) urls.push_back(url.str());
  for (const vrml::SFString& parameter : scene.get<vrml::MFString>(anchor, "parameter"))
    parameters.push_back(parameter.str());
  const vrml::SourceText& text = scene.nodes().text_of(anchor, url_field->slot);
  return link_of(urls, parameters, text.origin(), text.source());
}

Link link_of(const std::vector<std::string>& urls, const std::vector<std::string>& parameters,
             const vrml::SourceText& of, const std::shared_ptr<const vrml::TextSource>& source) {
  Link link;
  for (const std::string& text : parameters) {
    if (text.starts_with("target=") && text != "target=_self" && text != "target=_top" && text != "target=_parent")
      link.other_window = true;
  }
  // If the text was fetched at run time, relative URLs refer to its own URL.
  const bool is_fetched = source && source != of.source();
  const net::Url base = is_fetched ? net::parse_url(source->url) : base_of(of.file_name());
  for (const std::string& each : urls) {
    Link::Place place;
    net::Url url = net::resolve(base, net::parse_url(net::tidy_url(each)));
    place.viewpoint = std::exchange(url.fragment, {});
    url.has_fragment = false;
    net::Url own = base;
    own.fragment.clear();
    own.has_fragment = false;
    if (url.text() == own.text()) {
      if (place.viewpoint.empty()) continue;
    } else if (url.scheme == "file") {
      place.target = net::path_of_url(url);
      place.is_file = true;
      if (base.scheme != "file") place.problem = "Not opened: a world from the network links to a local file";
    } else {
      place.target = url.text();
      place.for_browser = is_for_browser(url);
      if (!place.for_browser && !net::find_scheme(url.scheme))
        place.problem = "\"" + url.scheme + ":\" is not a supported URL scheme";
      if (const auto refused = url.scheme == "ssh" ? refuse_account(base, url) : std::nullopt)
        place.problem = "Not opened: " + net::url_for_messages(url.text()) + ": " + refused->message;
    }
    link.places.push_back(std::move(place));
  }
  return link;
}

void keep_to_readable_files(Link& link, const vrml::SourceText& text, const std::vector<std::string>& allowed) {
  const net::Url base = base_of(text.file_name());
  if (base.scheme != "file") return;  // a network world, for which link_of() has already refused files
  const net::ReferencePolicy policy = policy_of_world(net::path_of_url(base), allowed);
  for (Link::Place& place : link.places) {
    if (!place.is_file || !place.problem.empty()) continue;
    // Refuse relative and missing names, such as "file:file:///x" or "x.wrl#". Opening such a name could read another
    // file.
    std::error_code error;
    if (!place.target.starts_with('/') || !std::filesystem::exists(place.target, error))
      place.problem = place.target + ": no such file";
    else if (const auto refused = policy.refuse_file({base.text()}, place.target))
      place.problem = place.target + ": " + refused->message;
  }
}

bool open_in_browser(const std::string& url) {
  if (!net::has_scheme(url, "http") && !net::has_scheme(url, "https") && !net::has_scheme(url, "mailto")) return false;
  std::string program = "xdg-open", argument = url;
  char* const arguments[] = {program.data(), argument.data(), nullptr};
  pid_t child = 0;
  if (posix_spawnp(&child, program.c_str(), nullptr, nullptr, arguments, environ) != 0) return false;
  // Do not wait: xdg-open passes the URL to the browser and exits by itself.
  return waitpid(child, nullptr, WNOHANG) >= 0;
}

}  // namespace gs::app
