#include "net/ssh/sftp_site.h"

#include "base/json_value.h"
#include "net/http/http_headers.h"
#include "net/serve/http_range.h"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace gs::net {
namespace {

constexpr std::size_t kMaxRequestBytes = std::size_t{32} << 10;
constexpr std::size_t kSftpConnections = 64;
/// Bytes of a body that were requested from the server and not taken by the client.
constexpr std::uint64_t kAhead = std::uint64_t{1} << 20;
/// Time without an answer after which the server counts as lost.
constexpr std::chrono::seconds kSftpPatience{60};

/// Returns a path for the server. Paths from "~" on are relative, and the server resolves them in the home folder.
std::string remote_path(const RequestPath& path) {
  const bool home = !path.names.empty() && path.names.front() == "~";
  std::string text;
  for (std::size_t i = home ? 1 : 0; i < path.names.size(); ++i) text += (home && i == 1 ? "" : "/") + path.names[i];
  if (text.empty()) return home ? "." : "/";
  return text;
}

std::string tag_of(const SftpAttributes& attributes) {
  char tag[48];
  std::snprintf(tag, sizeof tag, "\"%llx-%x-s\"", static_cast<unsigned long long>(attributes.size.value_or(0)),
                attributes.modified.value_or(0));
  return tag;
}

std::string phrase(int status) {
  switch (status) {
    case 200:
      return "200 OK";
    case 206:
      return "206 Partial Content";
    default:
      return std::to_string(status) + " Status";
  }
}

std::string field_of(std::string_view head, std::string_view name) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  while (!head.empty()) {
    const std::size_t end = std::min(head.find("\r\n"), head.size());
    const std::string_view line = head.substr(0, end);
    head.remove_prefix(std::min(end + 2, head.size()));
    if (line.size() <= name.size() || line[name.size()] != ':') continue;
    if (!std::equal(name.begin(), name.end(), line.begin(), [&](char a, char b) { return lower(a) == lower(b); }))
      continue;
    const std::size_t begin = line.find_first_not_of(' ', name.size() + 1);
    return begin == std::string_view::npos ? std::string() : std::string(line.substr(begin));
  }
  return {};
}

std::string take_word(std::string_view& line) {
  const std::size_t end = std::min(line.find(' '), line.size());
  std::string word(line.substr(0, end));
  line.remove_prefix(std::min(end + 1, line.size()));
  return word;
}

}  // namespace

struct SftpSite::Connection {
  ConnectionId id = 0;
  std::string request;  // received bytes of requests
  std::vector<std::byte> out;
  std::size_t out_begin = 0;
  bool ended = false;

  // Current request.
  bool busy = false, head_only = false;
  RequestPath path;
  std::string remote, limit, range;
  Conditions conditions;
  std::string handle;                                      // open file or folder; empty means none
  std::uint64_t next = 0, delivered = 0, end = 0;          // offsets of the body in the file
  std::map<std::uint64_t, std::vector<std::byte>> blocks;  // received blocks after `delivered`
  JsonValue entries = JsonValue::list();                   // of a folder
  std::size_t listed = 0;                                  // number of entries

  void put(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    out.insert(out.end(), bytes.begin(), bytes.end());
  }
};

SftpSite::SftpSite(Time now) : heard_(now) {}
SftpSite::~SftpSite() = default;

std::optional<std::string> SftpSite::receive(std::span<const std::byte> bytes, Time now) {
  if (!bytes.empty()) heard_ = now;
  return sftp_.receive(bytes);
}

std::optional<std::string> SftpSite::step(Time now) {
  if (sftp_.pending() == 0) heard_ = now;
  if (now - heard_ >= kSftpPatience) return "no answer for " + std::to_string(kSftpPatience.count()) + " s";
  return std::nullopt;
}

std::optional<Multiplexer::Time> SftpSite::deadline() const {
  return sftp_.pending() > 0 ? std::optional(heard_ + kSftpPatience) : std::nullopt;
}

Multiplexer::ConnectionId SftpSite::open() {
  if (connections_.size() >= kSftpConnections) return 0;
  auto connection = std::make_unique<Connection>();
  connection->id = ++last_id_;
  connections_[last_id_] = std::move(connection);
  return last_id_;
}

SftpSite::Connection* SftpSite::find(ConnectionId id) const {
  const auto found = connections_.find(id);
  return found == connections_.end() ? nullptr : found->second.get();
}

std::size_t SftpSite::room(ConnectionId id) const {
  const Connection* connection = find(id);
  return connection && !connection->ended ? kMaxRequestBytes - std::min(kMaxRequestBytes, connection->request.size())
                                          : 0;
}

void SftpSite::send(ConnectionId id, std::span<const std::byte> bytes) {
  Connection* connection = find(id);
  if (!connection) return;
  connection->request.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  begin_request(*connection);
}

std::span<const std::byte> SftpSite::received(ConnectionId id) const {
  const Connection* connection = find(id);
  return connection ? std::span(std::as_const(connection->out)).subspan(connection->out_begin)
                    : std::span<const std::byte>();
}

void SftpSite::took(ConnectionId id, std::size_t bytes) {
  Connection* connection = find(id);
  if (!connection) return;
  connection->out_begin += bytes;
  if (connection->out_begin >= connection->out.size() / 2) {
    connection->out.erase(connection->out.begin(),
                          connection->out.begin() + static_cast<std::ptrdiff_t>(connection->out_begin));
    connection->out_begin = 0;
  }
  read_on(*connection);
}

bool SftpSite::ended(ConnectionId id) const {
  const Connection* connection = find(id);
  return !connection || connection->ended;
}

void SftpSite::close(ConnectionId id) {
  if (const Connection* connection = find(id); connection && !connection->handle.empty())
    sftp_.close(connection->handle);
  connections_.erase(id);
}

/// Returns a receiver that does nothing if the connection was closed meanwhile, except to close a handle.
SftpClient::Take SftpSite::for_connection(ConnectionId id, Next next) {
  return [this, id, next = std::move(next)](const SftpAnswer& answer) {
    if (Connection* connection = find(id))
      next(*connection, answer);
    else if (answer.kind == SftpAnswer::Kind::handle)
      sftp_.close(answer.text);
  };
}

void SftpSite::begin_request(Connection& connection) {
  const std::size_t end = connection.request.find("\r\n\r\n");
  if (connection.busy || connection.ended) return;
  if (end == std::string::npos) {
    connection.ended = connection.request.size() >= kMaxRequestBytes;
    return;
  }
  const std::string head = connection.request.substr(0, end + 2);
  connection.request.erase(0, end + 4);
  connection.busy = true;
  std::string_view line = std::string_view(head).substr(0, head.find("\r\n"));
  const std::string method = take_word(line), target = take_word(line);
  connection.head_only = method == "HEAD";
  if (method != "GET" && method != "HEAD") return answer_text(connection, 405, "text/plain", "only GET and HEAD\n");
  auto path = parse_request_path(target.substr(0, target.find_first_of("?#")), true);
  if (const auto* refusal = std::get_if<PathRefusal>(&path))
    return answer_text(connection, refusal->status, "text/plain", refusal->message + "\n");
  connection.path = std::move(std::get<RequestPath>(path));
  connection.remote = remote_path(connection.path);
  connection.range = field_of(head, "Range");
  connection.conditions = {field_of(head, "If-Match"), field_of(head, "If-None-Match"),
                           field_of(head, "If-Modified-Since"), field_of(head, "If-Unmodified-Since"),
                           field_of(head, "If-Range")};
  const std::string within = field_of(head, kWithinField);
  if (within.empty()) return look(connection);
  const auto limit = parse_request_path(within, true);
  if (!std::holds_alternative<RequestPath>(limit))
    return answer_text(connection, 403, "text/plain", "the folder of the document is invalid\n");
  check_limit(connection, std::get<RequestPath>(limit));
}

/// Continues only if the target lies in the folder `limit` after links are followed. Opens the resolved path.
void SftpSite::check_limit(Connection& connection, const RequestPath& limit) {
  const auto first_name = [](const SftpAnswer& answer) {
    return answer.kind == SftpAnswer::Kind::names && answer.names.size() == 1 ? answer.names.front().name
                                                                              : std::string();
  };
  const ConnectionId id = connection.id;
  sftp_.real_path(remote_path(limit), for_connection(id, [this, id, first_name](Connection& here, const auto& folder) {
                    here.limit = first_name(folder);
                    sftp_.real_path(
                        here.remote, for_connection(id, [this, first_name](Connection& same, const auto& answer) {
                          const std::string real = first_name(answer);
                          if (real.empty()) return refuse(same, answer);
                          const std::string inside = same.limit.ends_with('/') ? same.limit : same.limit + "/";
                          if (same.limit.empty() || !real.starts_with(inside))
                            return answer_text(same, 403, "text/plain", "lies outside of the folder of the document\n");
                          same.remote = real;
                          look(same);
                        }));
                  }));
}

void SftpSite::look(Connection& connection) {
  sftp_.stat(connection.remote, for_connection(connection.id, [this](Connection& here, const SftpAnswer& answer) {
               take_attributes(here, answer);
             }));
}

void SftpSite::take_attributes(Connection& connection, const SftpAnswer& answer) {
  if (answer.kind != SftpAnswer::Kind::attributes) return refuse(connection, answer);
  if (answer.attributes.is_folder()) {
    if (!connection.path.folder) {
      RequestPath with_slash = connection.path;
      with_slash.folder = true;
      return answer_text(connection, 301, "text/plain", "this is a folder\n",
                         "Location: " + with_slash.text() + "\r\n");
    }
    return sftp_.open_folder(connection.remote,
                             for_connection(connection.id, [this](Connection& here, const SftpAnswer& opened) {
                               if (opened.kind != SftpAnswer::Kind::handle) return refuse(here, opened);
                               here.handle = opened.text;
                               here.entries = JsonValue::list();
                               here.listed = 0;
                               list(here, opened.text);
                             }));
  }
  if (!answer.attributes.is_file() || connection.path.folder)
    return answer_text(connection, 404, "text/plain", "not found\n");
  open_file(connection);
}

void SftpSite::open_file(Connection& connection) {
  const ConnectionId id = connection.id;
  sftp_.open(connection.remote, for_connection(id, [this, id](Connection& here, const SftpAnswer& opened) {
               if (opened.kind != SftpAnswer::Kind::handle) return refuse(here, opened);
               here.handle = opened.text;
               sftp_.stat_handle(opened.text, for_connection(id, [this](Connection& same, const SftpAnswer& answer) {
                                   if (answer.kind != SftpAnswer::Kind::attributes || !answer.attributes.size)
                                     return refuse(same, answer);
                                   answer_file(same, answer.attributes);
                                 }));
             }));
}

/// Reads the names of a folder, some at a time, and sends them in the form of `serve`.
void SftpSite::list(Connection& connection, const std::string& handle) {
  sftp_.read_folder(handle, for_connection(connection.id, [this, handle](Connection& here, const SftpAnswer& answer) {
                      if (answer.kind == SftpAnswer::Kind::names && !answer.names.empty() &&
                          here.listed < FolderListing::kMaxEntries) {
                        for (const SftpName& one : answer.names)
                          if (!one.name.starts_with('.') && ++here.listed <= FolderListing::kMaxEntries)
                            here.entries.add(JsonValue::named(
                                {{"name", one.name},
                                 {"url", "./" + encode_name(one.name) + (one.attributes.is_folder() ? "/" : "")},
                                 {"folder", one.attributes.is_folder()},
                                 {"modified", one.attributes.modified.value_or(0)},
                                 {"bytes", one.attributes.size.value_or(0)}}));
                        return list(here, handle);
                      }
                      std::string path = "/";
                      for (const std::string& name : here.path.names) path += name + "/";
                      answer_text(here, 200, "application/json",
                                  JsonValue::named({{"path", path},
                                                    {"complete", here.listed <= FolderListing::kMaxEntries},
                                                    {"entries", std::exchange(here.entries, JsonValue::list())}})
                                      .json());
                    }));
}

void SftpSite::answer_file(Connection& connection, const SftpAttributes& attributes) {
  const std::uint64_t size = *attributes.size;
  const std::string tag = tag_of(attributes);
  const std::int64_t modified = attributes.modified.value_or(0);
  const Verdict verdict = evaluate(connection.conditions, tag, modified);
  if (verdict == Verdict::failed) return answer_text(connection, 412, "text/plain", "the version differs\n");
  const std::string version = "ETag: " + tag + "\r\nLast-Modified: " + http_date(modified) +
                              "\r\nCache-Control: no-cache\r\nAccept-Ranges: bytes\r\n";
  if (verdict == Verdict::not_modified) return answer_text(connection, 304, {}, {}, version);
  ServedRange wanted{0, size};
  bool part = false;
  if (!connection.range.empty() && !connection.head_only && range_counts(connection.conditions, tag, modified)) {
    const auto ranges = parse_ranges(connection.range, size);
    if (std::holds_alternative<NoSuchRange>(ranges))
      return answer_text(connection, 416, "text/plain", "no such bytes\n",
                         "Content-Range: bytes */" + std::to_string(size) + "\r\n");
    const auto* some = std::get_if<std::vector<ServedRange>>(&ranges);
    part = some && some->size() == 1;
    if (part) wanted = some->front();
  }
  connection.put("HTTP/1.1 " + phrase(part ? 206 : 200) + "\r\n" + version +
                 "Content-Type: application/octet-stream\r\nContent-Length: " +
                 std::to_string(wanted.end - wanted.begin) + "\r\n" +
                 (part ? "Content-Range: bytes " + std::to_string(wanted.begin) + "-" + std::to_string(wanted.end - 1) +
                             "/" + std::to_string(size) + "\r\n"
                       : std::string()) +
                 "\r\n");
  connection.next = connection.delivered = wanted.begin;
  connection.end = connection.head_only ? wanted.begin : wanted.end;
  if (connection.next == connection.end) return end_request(connection);
  read_on(connection);
}

void SftpSite::answer_text(Connection& connection, int status, const std::string& mime, const std::string& body,
                           const std::string& more) {
  std::string head = "HTTP/1.1 " + phrase(status) + "\r\n" + more;
  if (status != 304) head += "Content-Type: " + mime + "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n";
  connection.put(head + "\r\n" + (connection.head_only || status == 304 ? std::string() : body));
  end_request(connection);
}

void SftpSite::refuse(Connection& connection, const SftpAnswer& answer) {
  int status = 502;
  if (answer.kind == SftpAnswer::Kind::status && answer.status == kSftpNoFile) status = 404;
  if (answer.kind == SftpAnswer::Kind::status && answer.status == kSftpNotPermitted) status = 403;
  answer_text(connection, status, "text/plain", "not readable\n");
}

void SftpSite::end_request(Connection& connection) {
  if (!connection.handle.empty()) sftp_.close(connection.handle);
  connection.handle.clear();
  connection.blocks.clear();
  connection.next = connection.delivered = connection.end = 0;
  connection.busy = false;
  begin_request(connection);
}

void SftpSite::read_on(Connection& connection) {
  while (connection.next < connection.end && !connection.ended) {
    const std::uint64_t waiting = connection.out.size() - connection.out_begin;
    if (connection.next - connection.delivered + waiting >= kAhead) return;
    const auto bytes = static_cast<std::uint32_t>(std::min<std::uint64_t>(kSftpRead, connection.end - connection.next));
    read_block(connection, connection.next, bytes);
    connection.next += bytes;
  }
}

void SftpSite::read_block(Connection& connection, std::uint64_t offset, std::uint32_t bytes) {
  // The handle tells answers of this request from those of an earlier one.
  sftp_.read(connection.handle, offset, bytes,
             for_connection(connection.id, [this, offset, bytes, handle = connection.handle](Connection& here,
                                                                                             const SftpAnswer& answer) {
               if (here.handle == handle) take_block(here, offset, bytes, answer);
             }));
}

void SftpSite::take_block(Connection& connection, std::uint64_t offset, std::uint32_t bytes, const SftpAnswer& answer) {
  if (connection.ended) return;
  if (answer.kind != SftpAnswer::Kind::data || answer.data.empty() || answer.data.size() > bytes) {
    connection.ended = true;  // the file has become shorter or unreadable; the client sees a body that ends too early
    return;
  }
  connection.blocks[offset].assign(answer.data.begin(), answer.data.end());
  const auto got = static_cast<std::uint32_t>(answer.data.size());
  if (got < bytes) read_block(connection, offset + got, bytes - got);
  for (auto first = connection.blocks.begin();
       first != connection.blocks.end() && first->first == connection.delivered;) {
    connection.out.insert(connection.out.end(), first->second.begin(), first->second.end());
    connection.delivered += first->second.size();
    first = connection.blocks.erase(first);
  }
  if (connection.delivered == connection.end) return end_request(connection);
  read_on(connection);
}

}  // namespace gs::net
