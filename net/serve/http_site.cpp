#include "net/serve/http_site.h"

#include "net/base/siphash.h"
#include "net/serve/content_tag.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <span>

#include <fcntl.h>

namespace gs::net {
namespace {

// Bytes of files that are compressed on demand. Smaller files do not benefit; larger files should be stored compressed.
constexpr std::uint64_t kMinGzip = 512, kMaxGzip = std::uint64_t{64} << 20;
constexpr std::chrono::milliseconds kGzipWait{5000};
constexpr const char* kRetrySeconds = "2";
constexpr std::int64_t kYearSeconds = 365LL * 24 * 60 * 60;

std::string text_tag(const std::string& body) {
  char tag[32];
  std::snprintf(tag, sizeof tag, "\"%016llx-t\"",
                static_cast<unsigned long long>(siphash(SipKey{}, std::as_bytes(std::span(body)))));
  return tag;
}

// Returns the end of the authority if the target is a complete URL. Returns nullopt otherwise.
std::optional<std::size_t> end_of_authority(const std::string& target) {
  const std::size_t scheme = target.find("://");
  if (target.starts_with('/') || scheme == std::string::npos || scheme >= 8) return std::nullopt;
  return std::min(target.find_first_of("/?#", scheme + 3), target.size());
}

}  // namespace

std::pair<std::string, std::string> split_target(std::string target) {
  if (const auto end = end_of_authority(target)) {
    target = target.substr(*end);
    if (!target.starts_with('/')) target.insert(0, "/");
  }
  target = target.substr(0, target.find('#'));
  const std::size_t mark = target.find('?');
  return {target.substr(0, mark), mark == std::string::npos ? std::string() : target.substr(mark + 1)};
}

namespace {

// Returns the number in a query such as "from=1000": files are made only of files with at least as many bytes.
std::uint64_t least_size(std::string_view query) {
  constexpr std::string_view kKey = kLeastSizeQuery;
  std::uint64_t least = 0;
  if (query.starts_with(kKey)) (void)std::from_chars(query.data() + kKey.size(), query.data() + query.size(), least);
  return least;
}

bool wants_json(const HttpRequest& request, const std::string& query) {
  if (query == "json") return true;
  const std::size_t json = request.accept.find("application/json"), html = request.accept.find("text/html");
  return json != std::string::npos && (html == std::string::npos || json < html);
}

}  // namespace

std::uint64_t HttpAnswer::size() const {
  std::uint64_t all = 0;
  for (const AnswerPart& part : parts) all += part.size();
  return all;
}

std::string message_for_clients(std::string message, const std::string& root) {
  const auto begins_path = [&](std::size_t at) {
    return at == 0 || std::string_view(" \t'\"`([{<:=,;|").find(message[at - 1]) != std::string_view::npos;
  };
  const std::string inside = root.ends_with('/') ? root : root + "/";
  for (std::size_t at = 0; (at = message.find(inside, at)) != std::string::npos;)
    if (begins_path(at))
      message.erase(at, inside.size());
    else
      at += inside.size();
  for (std::size_t at = 0; (at = message.find('/', at)) != std::string::npos; ++at)
    if (begins_path(at)) return "it cannot be read; the server's log has the reason";
  return message;
}

HttpSite::HttpSite(const HttpServerOptions& options, ServedFolder folder, MadeFiles* made,
                   std::function<std::string()> metrics)
    : options_(options),
      names_(options.bind, options.host_names),
      root_(std::move(folder)),
      made_(made),
      metrics_(std::move(metrics)) {}

void HttpSite::add_common(HttpAnswer& answer) { answer.headers.emplace_back("X-Content-Type-Options", "nosniff"); }

// Adds CORS headers (https://fetch.spec.whatwg.org), which let pages of allowed origins read the response.
void HttpSite::add_sharing(const HttpRequest& request, HttpAnswer& answer) const {
  auto& headers = answer.headers;
  const auto lists = [&](const std::string& origin) {
    return std::find(options_.origins.begin(), options_.origins.end(), origin) != options_.origins.end();
  };
  const bool all = lists("*"), this_one = !all && !request.origin.empty() && lists(request.origin);
  if (!all && !options_.origins.empty()) headers.emplace_back("Vary", "Origin");
  headers.emplace_back("Cross-Origin-Resource-Policy", all || this_one ? "cross-origin" : "same-origin");
  if (!all && !this_one) return;
  headers.emplace_back("Access-Control-Allow-Origin", all ? "*" : request.origin);
  headers.emplace_back("Access-Control-Expose-Headers",
                       "Accept-Ranges, Content-Encoding, Content-Length, "
                       "Content-Range, ETag, Retry-After");
  if (request.method != "OPTIONS") return;
  headers.emplace_back("Access-Control-Allow-Methods", "GET, HEAD, OPTIONS");
  headers.emplace_back("Access-Control-Allow-Headers",
                       "Range, If-Range, If-Match, If-None-Match, "
                       "If-Modified-Since, If-Unmodified-Since, "
                       "Cache-Control");
  headers.emplace_back("Access-Control-Max-Age", "86400");
}

void HttpSite::add_freshness(HttpAnswer& answer) const {
  std::string text = "no-cache";
  if (options_.max_age > 0) text = "public, max-age=" + std::to_string(options_.max_age);
  if (options_.max_age >= kYearSeconds) text += ", immutable";  // RFC 8246
  answer.headers.emplace_back("Cache-Control", text);
}

HttpAnswer HttpSite::problem(int status, const std::string& message) {
  HttpAnswer answer;
  answer.status = status;
  answer.parts.push_back({message + "\n", {}});
  answer.headers.emplace_back("Content-Type", "text/plain; charset=utf-8");
  answer.headers.emplace_back("Cache-Control", "no-store");
  if (status == 405) answer.headers.emplace_back("Allow", "GET, HEAD, OPTIONS");
  if (status == 503 || status == 202) answer.headers.emplace_back("Retry-After", kRetrySeconds);
  if (status == 429) answer.headers.emplace_back("Retry-After", "1");
  add_common(answer);
  return answer;
}

HttpAnswer HttpSite::text(const HttpRequest& request, const std::string& mime, std::string body) const {
  HttpAnswer answer;
  const std::string tag = text_tag(body);
  answer.headers.emplace_back("ETag", tag);
  answer.headers.emplace_back("Cache-Control", "no-cache");
  answer.headers.emplace_back("Vary", "Accept");
  add_common(answer);
  Conditions known = request.conditions;
  known.if_modified_since.clear();
  known.if_unmodified_since.clear();
  const Verdict verdict = evaluate(known, tag, 0);
  if (verdict == Verdict::failed) return problem(412, "the version differs");
  if (verdict == Verdict::not_modified) {
    answer.status = 304;
    return answer;
  }
  answer.headers.emplace_back("Content-Type", mime);
  // File names must not be able to run scripts in the listing.
  answer.headers.emplace_back("Content-Security-Policy",
                              "default-src 'none'; img-src 'self'; style-src 'unsafe-inline'");
  answer.parts.push_back({std::move(body), {}});
  return answer;
}

// Reports whether the Host field, or a target that is a complete URL, names this server (RFC 9112 3.2.2).
bool HttpSite::is_for_us(const HttpRequest& request) const {
  if (const auto end = end_of_authority(request.target)) {
    const std::size_t begin = request.target.find("://") + 3;
    if (!names_.admits(std::string_view(request.target).substr(begin, *end - begin))) return false;
  }
  return names_.admits(request.hosts.empty() ? std::string_view() : request.hosts.front());
}

HttpSite::Reply HttpSite::answer(const HttpRequest& request) const {
  // Send these errors without CORS headers: a request with a foreign host name may come from a malicious page.
  if (request.hosts.size() > 1) return problem(400, "expected one Host field");
  if (!is_for_us(request)) return problem(421, "unknown host name");
  Reply reply = answer_here(request);
  if (auto* answer = std::get_if<HttpAnswer>(&reply)) add_sharing(request, *answer);
  return reply;
}

HttpAnswer HttpSite::too_many(const HttpRequest& request) const {
  HttpAnswer answer = problem(429, "too many requests");
  add_sharing(request, answer);
  return answer;
}

HttpAnswer HttpSite::malformed(const std::string& why) {
  HttpAnswer answer = problem(400, why);
  answer.headers.emplace_back("Connection", "close");
  return answer;
}

HttpSite::Reply HttpSite::answer_here(const HttpRequest& request) const {
  if (request.method == "OPTIONS") {
    HttpAnswer answer;
    answer.status = 204;
    answer.headers.emplace_back("Allow", "GET, HEAD, OPTIONS");
    add_common(answer);
    return answer;
  }
  if (request.method == "POST" && options_.post) return post(request);
  if (request.method != "GET" && request.method != "HEAD") return problem(405, "only GET, HEAD and OPTIONS are served");
  const auto [path, query] = split_target(request.target);
  if (path == "/health") return text(request, "text/plain; charset=utf-8", "ok\n");
  if (path == "/metrics") {
    // A server on all interfaces accepts any host name. A page from a name that resolves to this machine must not read
    // the metrics.
    const bool own = !request.hosts.empty() && names_.is_own(request.hosts.front());
    if (!request.local || !own) return problem(404, "not found");
    return text(request, "text/plain; version=0.0.4; charset=utf-8", metrics_());
  }
  return get(request, path, query);
}

// Parses a path, and replaces "/~/" by the home folder.
std::variant<RequestPath, PathRefusal> HttpSite::path_of(const std::string& text) const {
  auto parsed = parse_request_path(text, options_.to_owner);
  auto* path = std::get_if<RequestPath>(&parsed);
  if (!path || options_.home.empty() || path->names.empty() || path->names.front() != "~") return parsed;
  std::string home;
  std::string_view left = options_.home;
  while (!left.empty()) {
    const std::size_t end = std::min(left.find('/'), left.size());
    if (end > 0) home += "/" + encode_name(left.substr(0, end));
    left.remove_prefix(std::min(end + 1, left.size()));
  }
  auto expanded = parse_request_path(home.empty() ? "/" : home, true);
  auto* whole = std::get_if<RequestPath>(&expanded);
  if (!whole) return expanded;
  whole->names.insert(whole->names.end(), path->names.begin() + 1, path->names.end());
  whole->folder = path->folder;
  return expanded;
}

HttpSite::Reply HttpSite::get(const HttpRequest& request, const std::string& path, const std::string& query) const {
  auto parsed = path_of(path);
  if (const auto* refusal = std::get_if<PathRefusal>(&parsed)) return problem(refusal->status, refusal->message);
  RequestPath& names = std::get<RequestPath>(parsed);
  if (!request.within.empty()) {
    const auto limit = path_of(request.within);
    const auto* outer = std::get_if<RequestPath>(&limit);
    if (!outer || names.names.size() < outer->names.size() ||
        !std::equal(outer->names.begin(), outer->names.end(), names.names.begin()))
      return problem(403, "lies outside of the folder of the document");
    names.within = outer->names.size();
  }
  auto opened = root_.open(names);
  if (const auto* refusal = std::get_if<PathRefusal>(&opened)) {
    if (refusal->status == 404) {
      if (auto reply = names.folder ? std::nullopt : made(request, names, query, true)) return std::move(*reply);
      if (auto reply = content(request, names)) return std::move(*reply);
      if (options_.missing && !names.folder)
        if (auto page = options_.missing(names.names.back(), request_of(request, names, query)))
          return text(request, page->mime, std::move(page->body));
    }
    return problem(refusal->status, refusal->message);
  }
  ServedFile& found = std::get<ServedFile>(opened);
  if (!found.folder) {
    if (!query.empty())
      if (auto reply = made(request, names, query, false)) return std::move(*reply);
    return file(request, names, std::move(found));
  }
  if (names.folder) return folder(request, names, query);
  HttpAnswer answer = problem(301, "this is a folder");
  RequestPath with_slash = names;
  with_slash.folder = true;
  answer.headers.emplace_back("Location", with_slash.text() + (query.empty() ? "" : "?" + query));
  return answer;
}

FolderRequest HttpSite::request_of(const HttpRequest& request, RequestPath path, const std::string& query) {
  FolderRequest result{wants_json(request, query), query, {}};
  if (!path.folder) path.names.pop_back();
  path.folder = true;
  const std::string host = request.hosts.empty() ? std::string() : request.hosts.front();
  if (host_of(host)) result.url = "http://" + host + path.text();
  return result;
}

HttpSite::Reply HttpSite::folder(const HttpRequest& request, const RequestPath& path, const std::string& query) const {
  if (query != "json" && !options_.patient) {
    RequestPath index = path;
    index.folder = false;
    index.names.emplace_back("index.html");
    auto opened = root_.open(index);
    if (auto* found = std::get_if<ServedFile>(&opened); found && !found->folder)
      return file(request, index, std::move(*found));
  }
  if (!options_.list) return problem(404, "folders are not listed");
  FolderPage page = options_.list(root_.list(path), request_of(request, path, query));
  return text(request, page.mime, std::move(page.body));
}

HttpSite::Reply HttpSite::file(const HttpRequest& request, const RequestPath& path, ServedFile found) const {
  Representation chosen;
  chosen.etag = found.stamp.etag();
  chosen.modified = found.stamp.seconds;
  chosen.file = std::move(found);
  if (options_.type_of) chosen.type = options_.type_of(path.names.back());
  if (auto wait = compress(request, path, chosen)) return *wait;
  return send(request, std::move(chosen));
}

// If the client accepts gzip, replaces `chosen` by a compressed version: a .gz file in the folder, or one that is made
// on demand. Returns a result if the request must wait for that file.
std::optional<WaitForMade> HttpSite::compress(const HttpRequest& request, const RequestPath& path,
                                              Representation& chosen) const {
  const FileStamp& stamp = chosen.file.stamp;
  const bool wanted = accepts_gzip(request.accept_encoding) && request.range.empty();
  RequestPath beside = path;
  beside.names.back() += ".gz";
  auto opened = root_.open(beside);
  auto* packed = std::get_if<ServedFile>(&opened);
  // Ignore a .gz file that is older than the file: it holds an earlier version.
  if (packed && (packed->folder || packed->stamp.seconds < stamp.seconds)) packed = nullptr;
  const bool on_the_fly = made_ && chosen.type.compress && stamp.size >= kMinGzip && stamp.size <= kMaxGzip;
  chosen.varies = packed || on_the_fly;
  if (!wanted || !chosen.varies) return std::nullopt;
  if (packed) {
    chosen.etag = packed->stamp.etag("-gz");
    chosen.file = std::move(*packed);
    chosen.gzip = true;
    return std::nullopt;
  }
  const std::size_t lane = options_.makers.size();
  const std::string source = ServedFolder::real_path(chosen.file.descriptor), etag = stamp.etag("-gz");
  const std::string key = "gzip " + etag + source;
  const MadeFile result = made_->request(
      lane, key, ".gz",
      [source](const std::string& out, const std::stop_token& stop) { return gzip_file(source, out, stop); });
  if (result.state == MadeState::waiting && !request.waited_long) return WaitForMade{lane, key, kGzipWait};
  if (result.state != MadeState::ready) return std::nullopt;
  Descriptor file(::open(result.path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (!file) return std::nullopt;
  chosen.file.descriptor = std::move(file);
  chosen.file.stamp = stamp_of(chosen.file.descriptor);
  chosen.etag = etag;
  chosen.gzip = true;
  return std::nullopt;
}

void HttpSite::add_ranges(HttpAnswer& answer, const std::vector<ServedRange>& ranges, const Representation& chosen) {
  const std::string &mime = chosen.type.mime, of = "/" + std::to_string(chosen.file.stamp.size);
  const auto text_of = [&](const ServedRange& range) {
    return "bytes " + std::to_string(range.begin) + "-" + std::to_string(range.end - 1) + of;
  };
  answer.status = 206;
  if (ranges.size() == 1) {
    answer.headers.emplace_back("Content-Type", mime);
    answer.headers.emplace_back("Content-Range", text_of(ranges.front()));
    answer.parts.push_back({{}, ranges.front()});
    return;
  }
  const std::string boundary = "ghostspace-" + chosen.etag.substr(1, chosen.etag.size() - 2);
  answer.headers.emplace_back("Content-Type", "multipart/byteranges; boundary=" + boundary);
  for (const ServedRange& range : ranges) {
    answer.parts.push_back(
        {"\r\n--" + boundary + "\r\nContent-Type: " + mime + "\r\nContent-Range: " + text_of(range) + "\r\n\r\n", {}});
    answer.parts.push_back({{}, range});
  }
  answer.parts.push_back({"\r\n--" + boundary + "--\r\n", {}});
}

HttpAnswer HttpSite::send(const HttpRequest& request, Representation chosen) const {
  const std::uint64_t size = chosen.file.stamp.size;
  const std::int64_t modified = chosen.modified;
  HttpAnswer answer;
  answer.headers.emplace_back("ETag", chosen.etag);
  answer.headers.emplace_back("Last-Modified", http_date(modified));
  if (chosen.varies) answer.headers.emplace_back("Vary", "Accept-Encoding");
  add_freshness(answer);
  add_common(answer);
  const Verdict verdict = evaluate(request.conditions, chosen.etag, modified);
  if (verdict == Verdict::failed) return problem(412, "the version differs");
  if (verdict == Verdict::not_modified) {
    answer.status = 304;
    return answer;
  }
  answer.headers.emplace_back("Accept-Ranges", "bytes");
  answer.stamp = chosen.file.stamp;
  answer.file = std::make_shared<const Descriptor>(std::move(chosen.file.descriptor));
  std::variant<WholeBody, NoSuchRange, std::vector<ServedRange>> ranges = WholeBody{};
  // Only GET has ranges (RFC 9110 14.2).
  if (!request.range.empty() && request.method == "GET" && range_counts(request.conditions, chosen.etag, modified))
    ranges = parse_ranges(request.range, size);
  if (std::holds_alternative<NoSuchRange>(ranges)) {
    answer = problem(416, "there are " + std::to_string(size) + " bytes");
    answer.headers.emplace_back("Content-Range", "bytes */" + std::to_string(size));
    return answer;
  }
  if (chosen.gzip) answer.headers.emplace_back("Content-Encoding", "gzip");
  if (const auto* some = std::get_if<std::vector<ServedRange>>(&ranges)) {
    add_ranges(answer, *some, chosen);
    return answer;
  }
  answer.headers.emplace_back("Content-Type", chosen.type.mime);
  if (size > 0) answer.parts.push_back({{}, {0, size}});
  return answer;
}

std::optional<HttpSite::Reply> HttpSite::made(const HttpRequest& request, const RequestPath& path,
                                              const std::string& query, bool missing) const {
  if (!made_ || path.names.empty()) return std::nullopt;
  for (std::size_t lane = 0; lane < options_.makers.size(); ++lane) {
    const Maker& maker = options_.makers[lane];
    if (maker.for_missing != missing) continue;
    const auto name = maker.source_of(path.names.back(), query);
    if (!name) continue;
    RequestPath source = path;
    source.names.back() = *name;
    auto opened = root_.open(source);
    const auto* file = std::get_if<ServedFile>(&opened);
    if (file && !file->folder && file->stamp.size >= least_size(query)) return make(request, lane, *file);
  }
  return std::nullopt;
}

std::pair<MadeFile, std::string> HttpSite::request_made(std::size_t lane, const ServedFile& source) const {
  const Maker& maker = options_.makers[lane];
  const std::string path = ServedFolder::real_path(source.descriptor);
  const std::string key = maker.name + " " + source.stamp.etag() + path;
  const auto make_it = [&maker, &options = options_, path, root = root_.path(), stamp = source.stamp](
                           const std::string& out, const std::stop_token& stop) -> std::optional<MakeFailure> {
    if (auto failed = maker.make(path, out, stop)) {
      if (options.report && !stop.stop_requested())
        options.report(maker.name + " of " + path + " failed: " + failed->message);
      failed->message = message_for_clients(std::move(failed->message), root);
      return failed;
    }
    // If the file has changed, the maker may have mixed two versions.
    const Descriptor now(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (!now || !(stamp_of(now) == stamp)) return MakeFailure{"the file changed during the request", false};
    store_content_tag(out, stop);
    return std::nullopt;
  };
  return {made_->request(lane, key, maker.extension, make_it), key};
}

HttpSite::Reply HttpSite::make(const HttpRequest& request, std::size_t lane, const ServedFile& source) const {
  const Maker& maker = options_.makers[lane];
  for (std::size_t i = 0; i < options_.makers.size() && !maker.coarse_of.empty(); ++i)
    if (options_.makers[i].name == maker.coarse_of && request_made(i, source).first.state != MadeState::waiting)
      return problem(404, "the complete file is ready; request it instead");
  const auto [result, key] = request_made(lane, source);
  switch (result.state) {
    case MadeState::failed:
      return result.failure.lasting ? problem(422, "cannot be generated: " + result.failure.message)
                                    : problem(503, "cannot be generated now; retry later");
    case MadeState::full:
      return problem(503, "too many files are being generated; retry later");
    case MadeState::waiting:
      if (request.method == "HEAD") return problem(202, "is being generated; retry later");
      if ((!request.range.empty() && !options_.patient) || request.waited_long)
        return problem(503, "is being generated; retry later");
      return WaitForMade{lane, key, maker.wait};
    case MadeState::ready:
      break;
  }
  Representation chosen;
  chosen.file.descriptor = Descriptor(::open(result.path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW));
  if (!chosen.file.descriptor) return problem(503, "was removed from the cache; retry");
  chosen.file.stamp = stamp_of(chosen.file.descriptor);
  // Without a stored tag, each server has its own. A client that changes servers then starts its transfer again.
  chosen.etag = content_tag_of(chosen.file.descriptor).value_or(chosen.file.stamp.etag("-m"));
  chosen.modified = chosen.file.stamp.seconds;
  chosen.type = maker.type;
  return send(request, std::move(chosen));
}

}  // namespace gs::net
