// Callbacks of libmicrohttpd: connections, requests and bodies of responses.
#include "net/base/host_names.h"
#include "net/http/http_headers.h"
#include "net/limits/clock.h"
#include "net/serve/http_loop.h"
#include "net/serve/microhttpd_library.h"
#include "net/serve/request_fields.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <exception>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace gs::net {
namespace {

constexpr std::size_t kAnswerBlock = 65536;

std::string header(MHD_Connection* handle, const char* name) {
  const char* value = microhttpd().MHD_lookup_connection_value(handle, MHD_HEADER_KIND, name);
  return value ? value : "";
}

const sockaddr* address_of(MHD_Connection* handle) {
  const MHD_ConnectionInfo* info = microhttpd().MHD_get_connection_info(handle, MHD_CONNECTION_INFO_CLIENT_ADDRESS);
  return info ? info->client_addr : nullptr;
}

// Values of all fields with one name (RFC 9110 5.3).
struct Fields {
  std::string_view name;
  std::vector<std::string> values;
};
MHD_Result collect_field(void* self, MHD_ValueKind, const char* name, const char* value) {
  auto& fields = *static_cast<Fields*>(self);
  const std::string_view key = name;
  const auto same = [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a + 32 : a) == b; };
  if (std::equal(key.begin(), key.end(), fields.name.begin(), fields.name.end(), same))
    fields.values.emplace_back(value ? value : "");
  return MHD_YES;
}
// Returns the values of all fields with a name. `name` is in lower case.
std::vector<std::string> fields_of(MHD_Connection* handle, std::string_view name) {
  Fields fields{name, {}};
  (void)microhttpd().MHD_get_connection_values(handle, MHD_HEADER_KIND, collect_field, &fields);
  return std::move(fields.values);
}
std::string joined_fields(const std::vector<std::string>& values) {
  std::string text;
  for (const std::string& value : values) text += (text.empty() ? "" : ",") + value;
  return text;
}

/// Reports whether a field continued on a second line (folded). libmicrohttpd before 1.0 then copies the name to new
/// memory. Otherwise, name and value are in one buffer with only blanks between them. Later versions refuse folded
/// lines.
bool is_folded(const char* name, const char* value) {
  static const bool tells = std::string_view(microhttpd().MHD_get_version()).starts_with("0.");
  if (!tells || !name || !value) return false;
  const char* const behind = name + std::strlen(name) + 1;
  const auto begin = reinterpret_cast<std::uintptr_t>(behind), end = reinterpret_cast<std::uintptr_t>(value);
  return end < begin || end - begin > kConnectionMemory ||
         !std::all_of(behind, behind + (end - begin), [](char c) { return c == ' ' || c == '\t'; });
}
MHD_Result collect_received(void* self, MHD_ValueKind, const char* name, const char* value) {
  static_cast<std::vector<ReceivedField>*>(self)->push_back(
      {name ? name : "", value ? value : "", is_folded(name, value)});
  return MHD_YES;
}
std::vector<ReceivedField> received_fields(MHD_Connection* handle) {
  std::vector<ReceivedField> fields;
  (void)microhttpd().MHD_get_connection_values(handle, MHD_HEADER_KIND, collect_received, &fields);
  return fields;
}

std::optional<IpAddress> peer_of(MHD_Connection* handle) {
  const sockaddr* address = address_of(handle);
  return address ? ip_address_of(address) : std::nullopt;
}

// Reports whether a request came through a proxy, by fields that browsers never send.
bool came_through_proxy(MHD_Connection* handle) {
  for (const char* name : {"Forwarded", "X-Forwarded-For", "X-Real-IP", "Via"})
    if (!header(handle, name).empty()) return true;
  return false;
}

bool has_body(MHD_Connection* handle) {
  const std::string length = header(handle, "Content-Length");
  return !header(handle, "Transfer-Encoding").empty() || length.find_first_not_of('0') != std::string::npos;
}

}  // namespace

struct HttpLoop::Transfer {
  HttpLoop* loop = nullptr;
  Connection* connection = nullptr;
  HttpAnswer answer;
  std::uint64_t id = 0, sent = 0;
};

void HttpLoop::on_connection(void* self, MHD_Connection* handle, void** context, MHD_ConnectionNotificationCode code) {
  auto* loop = static_cast<HttpLoop*>(self);
  const Instant now = clock_now();
  if (code == MHD_CONNECTION_NOTIFY_CLOSED) {
    const std::unique_ptr<Connection> connection(static_cast<Connection*>(*context));
    if (!connection) return;
    loop->connections_.erase(connection.get());
    if (connection->counted) loop->limits_.close(connection->peer, connection->shared, now);
  } else {
    auto connection = std::make_unique<Connection>();
    connection->loop = loop;
    connection->handle = handle;
    const auto peer = peer_of(handle);
    connection->peer = connection->client = client_key(address_of(handle));
    connection->shared = peer && is_one_of(loop->options_.proxies, *peer);
    connection->since = now;
    if (const auto* info = microhttpd().MHD_get_connection_info(handle, MHD_CONNECTION_INFO_CONNECTION_FD))
      connection->socket = info->connect_fd;
    connection->counted = loop->limits_.open(connection->peer, connection->shared, now);
    if (!connection->counted) (void)::shutdown(connection->socket, SHUT_RDWR);
    const std::lock_guard lock(loop->mutex_);
    ++(connection->counted ? loop->statistics_.accepted : loop->statistics_.refused);
    loop->connections_.insert(connection.get());
    *context = connection.release();
  }
  const std::lock_guard lock(loop->mutex_);
  loop->statistics_.connections = loop->limits_.connections();
}

void* HttpLoop::on_target(void* self, const char* target, MHD_Connection* handle) {
  auto* loop = static_cast<HttpLoop*>(self);
  auto request = std::make_unique<Request>();
  request->loop = loop;
  if (const auto* info = microhttpd().MHD_get_connection_info(handle, MHD_CONNECTION_INFO_SOCKET_CONTEXT))
    request->connection = static_cast<Connection*>(info->socket_context);
  request->request.target = target;
  request->begin = clock_now();
  request->record.time = ::time(nullptr);
  request->record.client = client_name(address_of(handle));
  request->id = loop->next_id_++;
  const std::lock_guard lock(loop->mutex_);
  ++loop->statistics_.transfers;
  return request.release();
}

MHD_Result HttpLoop::on_request(void* self, MHD_Connection* handle, const char*, const char* method,
                                const char* version, const char*, std::size_t* upload_size, void** context) {
  auto* loop = static_cast<HttpLoop*>(self);
  auto* request = static_cast<Request*>(*context);
  if (!request || !request->connection) return MHD_NO;
  if (*upload_size != 0) return MHD_NO;
  try {
    return loop->handle(*request, handle, method, version);
  } catch (const std::exception&) {
    return MHD_NO;  // closes this connection; libmicrohttpd is C and must not see exceptions
  }
}

MHD_Result HttpLoop::handle(Request& request, MHD_Connection* handle, const char* method, const char* version) {
  HttpRequest& asked = request.request;
  const Instant now = clock_now();
  if (!request.seen) {
    request.seen = true;
    asked.method = method;
    request.record.version = version;
    request.connection->phase = Phase::sending;
    request.connection->since = now;
    if (const auto why = refuse_fields(received_fields(handle), version))
      return queue(request, handle, HttpSite::malformed(*why));
    // Answer a request with a body at once and close the connection, so that its body and trailers are not read.
    if (!has_body(handle)) return MHD_YES;
  }
  if (request.until) {
    asked.waited_long = now >= *request.until;
    request.connection->phase = Phase::sending;
    request.connection->since = now;
    return reply(request, handle);
  }
  asked.range = header(handle, "Range");
  asked.accept = header(handle, "Accept");
  asked.within = header(handle, kWithinField);
  asked.authorization = header(handle, "Authorization");
  asked.has_body = has_body(handle);
  asked.accept_encoding = header(handle, "Accept-Encoding");
  asked.conditions = {header(handle, "If-Match"), header(handle, "If-None-Match"), header(handle, "If-Modified-Since"),
                      header(handle, "If-Unmodified-Since"), header(handle, "If-Range")};
  asked.hosts = fields_of(handle, "host");
  asked.origin = header(handle, "Origin");
  const auto peer = peer_of(handle);
  asked.local = peer && is_loopback(*peer) && !request.connection->shared && !came_through_proxy(handle);
  if (peer && request.connection->shared) {
    const IpAddress client = client_of(*peer, joined_fields(fields_of(handle, "x-forwarded-for")), options_.proxies);
    request.connection->client = client_key(client);
    request.record.client = address_text(client);
    request.counted = limits_.begin(request.connection->client, now);
  }
  if ((request.connection->shared && !request.counted) || !limits_.admit(request.connection->client, now))
    return queue(request, handle, site_->too_many(asked));
  return reply(request, handle);
}

MHD_Result HttpLoop::reply(Request& request, MHD_Connection* handle) {
  if (aborting_) return MHD_NO;
  HttpSite::Reply found = site_->answer(request.request);
  if (auto* answer = std::get_if<HttpAnswer>(&found)) return queue(request, handle, std::move(*answer));
  auto& wait = std::get<WaitForMade>(found);
  if (!request.until) request.until = clock_now() + std::chrono::duration_cast<Instant>(wait.wait);
  request.connection->phase = Phase::waiting;
  request.request.later = wait.later;
  waiting_[request.id] = {handle, wait.lane, wait.key, *request.until, wait.content, std::move(wait.later)};
  microhttpd().MHD_suspend_connection(handle);
  return MHD_YES;
}

MHD_Result HttpLoop::queue(Request& request, MHD_Connection* handle, HttpAnswer answer) {
  request.record.status = answer.status;
  auto transfer = std::make_unique<Transfer>();
  transfer->loop = this;
  transfer->connection = request.connection;
  transfer->id = next_id_++;
  transfer->answer = std::move(answer);
  const HttpAnswer& all = transfer->answer;
  const std::uint64_t size = all.size();
  const auto read_body = [](void* self, std::uint64_t at, char* to, std::size_t most) -> ssize_t {
    auto& one = *static_cast<Transfer*>(self);
    return one.loop->read_paced(one, at, to, most);
  };
  const auto free_body = [](void* self) { delete static_cast<Transfer*>(self); };
  const std::size_t block = static_cast<std::size_t>(std::clamp<std::uint64_t>(size, 1024, kAnswerBlock));
  MHD_Response* response =
      size == 0 ? microhttpd().MHD_create_response_from_buffer(0, nullptr, MHD_RESPMEM_PERSISTENT)
                : microhttpd().MHD_create_response_from_callback(size, block, read_body, transfer.get(), free_body);
  if (!response) return MHD_NO;
  for (const auto& [name, value] : all.headers)
    (void)microhttpd().MHD_add_response_header(response, name.c_str(), value.c_str());
  if (quiet_) (void)microhttpd().MHD_add_response_header(response, "Connection", "close");
  const auto status = static_cast<unsigned>(all.status);
  if (size != 0) (void)transfer.release();  // the response owns the transfer now
  const MHD_Result queued = microhttpd().MHD_queue_response(handle, status, response);
  microhttpd().MHD_destroy_response(response);
  return queued;
}

void HttpLoop::on_completed(void*, MHD_Connection*, void** context, MHD_RequestTerminationCode) {
  const std::unique_ptr<Request> request(static_cast<Request*>(*context));
  *context = nullptr;
  if (request) request->loop->completed(*request);
}

void HttpLoop::completed(Request& request) {
  const Instant now = clock_now();
  waiting_.erase(request.id);
  AccessRecord& record = request.record;
  if (request.connection) {
    if (request.counted) limits_.end(request.connection->client, now);
    record.bytes = request.connection->sent;
    request.connection->sent = 0;
    request.connection->phase = Phase::receiving;
    request.connection->since = now;
  }
  record.method = request.request.method.empty() ? "-" : request.request.method;
  record.target = request.request.target;
  record.seconds = std::chrono::duration<double>(now - request.begin).count();
  options_.log.write(log_line(record));
  const std::lock_guard lock(mutex_);
  --statistics_.transfers;
  ++statistics_.requests[record.status];
}

// Reads bytes of a body within the bandwidth limit. Suspends the connection until its turn if it has no credit.
ssize_t HttpLoop::read_paced(Transfer& transfer, std::uint64_t at, char* to, std::size_t most) {
  Connection& connection = *transfer.connection;
  if (aborting_) return MHD_CONTENT_READER_END_WITH_ERROR;
  connection.since = clock_now();
  if (limits_.paced()) {
    if (connection.credit == 0) {
      connection.phase = Phase::waiting;
      turns_[transfer.id] = connection.handle;
      limits_.wait(connection.client, transfer.id, connection.since);
      microhttpd().MHD_suspend_connection(connection.handle);
      return 0;
    }
    most = std::min(most, connection.credit);
  }
  const ssize_t got = read(transfer, at, to, most);
  if (got <= 0) return MHD_CONTENT_READER_END_WITH_ERROR;
  const auto bytes = static_cast<std::size_t>(got);
  if (limits_.paced()) connection.credit -= bytes;
  connection.sent += bytes;
  const std::lock_guard lock(mutex_);
  statistics_.bytes += bytes;
  return got;
}

ssize_t HttpLoop::read(Transfer& transfer, std::uint64_t at, char* to, std::size_t most) {
  const HttpAnswer& answer = transfer.answer;
  // The headers describe one version of the file. If the file has changed, stop.
  if (answer.file && !(stamp_of(*answer.file) == answer.stamp)) return -1;
  for (const AnswerPart& part : answer.parts) {
    const std::uint64_t size = part.size();
    if (at >= size) {
      at -= size;
      continue;
    }
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(most, size - at));
    if (!part.text.empty()) {
      std::copy_n(part.text.data() + at, count, to);
      return static_cast<ssize_t>(count);
    }
    ssize_t got = -1;
    do {
      got = ::pread(answer.file->get(), to, count, static_cast<off_t>(part.range.begin + at));
    } while (got < 0 && errno == EINTR);
    return got;
  }
  return -1;
}

}  // namespace gs::net
