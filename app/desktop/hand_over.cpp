#include "app/desktop/hand_over.h"

#include "app/session/documents/link_file.h"
#include "net/base/schemes.h"
#include "net/base/url.h"
#include "net/control/control_caller.h"
#include "net/control/control_server.h"
#include "net/control/control_token.h"
#include "net/files/file.h"

#include <nlohmann/json.hpp>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <span>
#include <utility>

#include <sys/stat.h>
#include <unistd.h>

namespace gs::app {
namespace {

constexpr std::chrono::milliseconds kPatience{5000};  // max wait of the sending process; then it opens its own window
constexpr std::size_t kMaxFilesHanded = 1000;  // max files in one message
constexpr char kSocketName[] = "/window.sock", kTokenName[] = "/window.token";

bool is_ours_alone(const std::string& folder) {
  struct stat about {};
  return ::lstat(folder.c_str(), &about) == 0 && S_ISDIR(about.st_mode) && about.st_uid == ::geteuid() &&
         (about.st_mode & 077) == 0;
}

std::string token_in(const std::string& folder) {
  const auto opened = net::map_file(folder + kTokenName);
  const auto* file = std::get_if<net::MappedFile>(&opened);
  if (!file) return {};
  std::string text(reinterpret_cast<const char*>(file->bytes().data()), file->bytes().size());
  return text.substr(0, text.find('\n'));
}

}  // namespace

std::string absolute_place(const std::string& place) {
  const net::Url url = net::parse_url(place);
  if (place.empty() || net::has_scheme(place, kLinkScheme) || (!url.scheme.empty() && net::find_scheme(url.scheme)))
    return place;
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(place, error);
  return error ? place : absolute.lexically_normal().string();
}

std::string hand_over_folder() {
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  if (!runtime || runtime[0] != '/' || !is_ours_alone(runtime)) return {};
  const std::string folder = std::string(runtime) + "/ghostspace";
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) return {};
  return is_ours_alone(folder) ? folder : std::string();
}

bool hand_over(const std::string& folder, const std::vector<std::string>& files) {
  const std::string token = folder.empty() ? std::string() : token_in(folder);
  if (token.empty()) return false;
  nlohmann::json message = {{"open", nlohmann::json::array()}};
  for (const std::string& file : files) message["open"].push_back(absolute_place(file));
  const auto answer = net::call_control(
      folder + kSocketName, token, message.dump(-1, ' ', true, nlohmann::json::error_handler_t::ignore), kPatience);
  const auto* text = std::get_if<std::string>(&answer);
  return text && *text == "taken";
}

HandOver::HandOver(std::unique_ptr<net::ControlServer> server) : server_(std::move(server)) {}
HandOver::~HandOver() = default;

std::unique_ptr<HandOver> HandOver::listen(const std::string& folder, std::function<void()> wake) {
  if (folder.empty()) return nullptr;
  net::ControlServerOptions options;
  options.paths = {folder + kSocketName};
  options.terms.token = net::make_control_token();
  options.terms.limits.clients = 4;
  options.terms.limits.message_bytes = std::size_t{1} << 20;
  options.terms.farewell = [](const std::string&) { return std::string("refused"); };
  const std::string token = options.terms.token;
  options.ready = [&] { return net::write_control_token(folder + kTokenName, token); };
  auto started = net::ControlServer::start(std::move(options), std::move(wake));
  auto* server = std::get_if<std::unique_ptr<net::ControlServer>>(&started);
  return server ? std::unique_ptr<HandOver>(new HandOver(std::move(*server))) : nullptr;
}

HandOver::Taken HandOver::take() {
  Taken taken;
  while (const auto news = server_->next()) {
    if (news->left) continue;
    const auto message = nlohmann::json::parse(news->message, nullptr, false);
    const auto open = message.is_object() ? message.find("open") : message.end();
    const bool good =
        message.is_object() && open != message.end() && open->is_array() && open->size() <= kMaxFilesHanded;
    (void)server_->send(news->client, good ? "taken" : "refused");
    if (!good) continue;
    taken.asked = true;
    for (const auto& file : *open)
      if (file.is_string()) taken.files.push_back(file.get<std::string>());
  }
  return taken;
}

}  // namespace gs::app
