#include "app/session/running/network_gate.h"

#include "net/base/schemes.h"
#include "net/base/url.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kMaxHeld = 1000, kMaxTold = 32;

bool is_network_url(const net::Url& url, bool may_refer) {
  if (url.scheme == "mailto") return true;
  if (url.scheme == "data") return may_refer;
  const net::Scheme* const scheme = net::find_scheme(url.scheme);
  // Documents reach only the folder of their own account by ssh, as they reach local files.
  return scheme && scheme->transport != net::TransportKind::file && scheme->name != "ssh";
}

std::vector<std::string> texts_of(const vrml::MFString& list) {
  std::vector<std::string> texts;
  for (const vrml::SFString& one : list) texts.push_back(one.str());
  return texts;
}

// Returns the first URL in a list that reaches the network; nullopt if none does. If `may_refer`, a data: URL also
// counts, because its content may contain further URLs.
std::optional<net::Url> first_network_url(const std::vector<std::string>& urls, const vrml::TextSource* source,
                                          bool may_refer) {
  const net::Url base = net::parse_url(source ? source->url : std::string());
  for (const std::string& one : urls)
    if (net::Url url = net::resolve(base, net::parse_url(net::tidy_url(one))); is_network_url(url, may_refer))
      return url;
  return std::nullopt;
}

// Returns true if the requested content may contain URLs. Scenes, programs and PROTOs may; images, sounds and vectors
// cannot.
bool may_refer(const UrlRequest& request) {
  return request.as_text || request.prototype || request.content == vrml::UrlContent::scene;
}

}  // namespace

void NetworkGate::refuse() {
  decision_ = Decision::refused;
  urls_.clear();
  scripts_.clear();
}

void NetworkGate::close(const std::string& file) {
  if (decision_ != Decision::open) return;
  decision_ = Decision::asks;
  file_ = file;
}

template <class Request, class Needs, class UrlsOf>
std::vector<std::string> NetworkGate::move_held(std::vector<Request>& from, std::vector<Request>& to,
                                                const Needs& needs, const UrlsOf& urls_of) {
  std::vector<std::string> messages;
  if (decision_ == Decision::open || decision_ == Decision::allowed) return messages;
  std::vector<Request> kept;
  for (Request& one : from) {
    const std::optional<net::Url> url = needs(one) ? urls_of(one) : std::nullopt;
    if (!url) {
      kept.push_back(std::move(one));
      continue;
    }
    const std::string place = url->scheme == "data" ? "a data: URL" : net::url_for_messages(url->text());
    if (told_.size() < kMaxTold && told_.insert(url->scheme + "://" + url->authority).second)
      messages.push_back(place + " is not requested, because a Script of this world has read " +
                         net::url_for_messages(file_) + "; --allow-network allows it");
    if (decision_ == Decision::refused || to.size() >= kMaxHeld) continue;
    if (first_url_.empty()) first_url_ = place;
    to.push_back(std::move(one));
  }
  from = std::move(kept);
  return messages;
}

std::vector<std::string> NetworkGate::hold_back(std::vector<UrlRequest>& requests) {
  return move_held(
      requests, urls_, [](const UrlRequest& one) { return one.computed; },
      [](const UrlRequest& one) { return first_network_url(texts_of(one.urls), one.source.get(), may_refer(one)); });
}

std::vector<std::string> NetworkGate::hold_back(std::vector<ScriptRequest>& requests) {
  return move_held(
      requests, scripts_, [](const ScriptRequest& one) { return one.kind == ScriptRequest::Kind::load_url; },
      [](const ScriptRequest& one) { return first_network_url(one.urls, one.source.get(), true); });
}

std::optional<NetworkQuestion> NetworkGate::question() const {
  if (decision_ != Decision::asks || (urls_.empty() && scripts_.empty())) return std::nullopt;
  return NetworkQuestion{file_, first_url_};
}

std::vector<UrlRequest> NetworkGate::take_url_requests() {
  return decision_ == Decision::allowed ? std::exchange(urls_, {}) : std::vector<UrlRequest>();
}

std::vector<ScriptRequest> NetworkGate::take_script_requests() {
  return decision_ == Decision::allowed ? std::exchange(scripts_, {}) : std::vector<ScriptRequest>();
}

void NetworkGate::forget_scene(const vrml::SceneGraph& scene) {
  std::erase_if(urls_, [&](const UrlRequest& one) { return one.place.scene == &scene; });
  std::erase_if(scripts_, [&](const ScriptRequest& one) { return one.scene == &scene || one.from_scene == &scene; });
}

}  // namespace gs::app
