#include "net/load/job_location.h"

#include <algorithm>
#include <string_view>

namespace gs::net {
namespace {

bool has_control_or_blank(std::string_view text, bool blank_too) {
  return std::any_of(text.begin(), text.end(), [blank_too](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7f || (blank_too && byte == 0x20);
  });
}

}  // namespace

JobLocation::JobLocation(const LoaderOptions& options, const Request& request)
    : options_(options), request_(request), reach_(request.from.reach()) {
  set_url(request.url);
}

void JobLocation::set_url(std::string url) {
  const std::string name = parse_url(std::string_view(url).substr(0, 32)).scheme;
  scheme_ = find_scheme(name);
  host_.clear();
  // Write the scheme in lower case.
  if (scheme_) url.replace(0, name.size(), name);
  // The fragment is removed from all URLs except data: URLs, where it is part of the data.
  if (!scheme_ || scheme_->transport != TransportKind::data) url.resize(std::min(url.find('#'), url.size()));
  url_ = std::move(url);
  if (!scheme_ || !scheme_->has_host) return;
  // Use the canonical URL for cache, policy, transport and document. Leave a URL without a host unchanged; the policy
  // refuses it.
  if (const auto canonical = canonical_url(parse_url(url_))) {
    url_ = canonical->text();
    host_ = canonical->scheme + "://" + canonical->authority;
  }
}

void JobLocation::narrow_reach(AddressSpace space) { reach_ = std::max(reach_, space); }

std::optional<std::string> JobLocation::invalid() const {
  constexpr std::size_t kLongestUrl = 16384;
  const bool data = scheme_ && scheme_->transport == TransportKind::data;
  if (url_.empty()) return "it is empty; expected an absolute URL";
  if (!data && url_.size() > kLongestUrl) return "it is longer than " + std::to_string(kLongestUrl) + " bytes";
  if (!data && has_control_or_blank(url_, true))
    return "it contains a blank or a control character; expected percent-encoding";
  if (has_control_or_blank(request_.accept, false)) return "the accepted media types contain a control character";
  if (request_.ranges.size() > options_.max_ranges)
    return std::to_string(request_.ranges.size()) + " ranges were requested; expected at most " +
           std::to_string(options_.max_ranges);
  for (const ByteRange& range : request_.ranges)
    if (range.empty())
      return "an empty range was requested (" + std::to_string(range.begin) + " to " + std::to_string(range.end) + ")";
  return std::nullopt;
}

std::optional<LoadError> JobLocation::forbidden() const {
  const bool data = scheme_ && scheme_->transport == TransportKind::data;
  const auto why = options_.policy.refuse(request_.from, parse_url(data ? "data:" : url_));
  if (!why) return std::nullopt;
  return LoadError{scheme_ ? LoadErrorKind::forbidden : LoadErrorKind::unsupported, why->message, 0};
}

std::variant<Url, LoadError> JobLocation::redirect_target(const std::string& location, AddressSpace space) {
  constexpr std::size_t kLongest = 8192;
  if (redirects_ >= options_.max_redirects)
    return LoadError{LoadErrorKind::too_many_redirects,
                     "too many redirects; expected at most " + std::to_string(redirects_) + " redirects", 0};
  if (location.size() > kLongest)
    return LoadError{LoadErrorKind::bad_response, "the server redirects to an invalid URL", 0};
  const Url target = resolve(parse_url(url_), parse_url(tidy_url(location)));
  const Scheme* const scheme = find_scheme(target.scheme);
  // memory: URLs may redirect to memory: URLs, for tests.
  const bool within_memory = scheme && scheme == scheme_ && scheme->transport == TransportKind::memory;
  // A folder is redirected to its URL with a slash.
  const bool within_account =
      scheme && scheme == scheme_ && scheme->name == "ssh" && target.authority == parse_url(url_).authority;
  if (!scheme || (!scheme->redirect_target && !within_memory && !within_account))
    return LoadError{LoadErrorKind::forbidden,
                     "the server redirects to " + url_for_messages(target.text()) + "; expected http or https", 0};
  // The redirect has the same rights as a document of that server.
  narrow_reach(Origin{url_, space}.reach());
  if (const auto why = options_.policy.refuse({url_, space}, target))
    return LoadError{LoadErrorKind::forbidden,
                     "the server redirects to " + url_for_messages(target.text()) + ": " + why->message, 0};
  return target;
}

void JobLocation::redirect_to(const Url& target) {
  ++redirects_;
  set_url(target.text());
}

std::string JobLocation::failure_text() const {
  std::string text = "cannot load " + url_for_messages(url_);
  if (redirects_ > 0) text += " (redirected from " + url_for_messages(request_.url) + ")";
  return text;
}

}  // namespace gs::net
