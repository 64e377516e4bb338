
#include "app/commands/options/options.h"
#include "app/base/text.h"
#include "app/commands/options/encode_options.h"
#include "app/commands/options/option_values.h"
#include "app/commands/options/picture_options.h"
#include "app/formats/content_types.h"
#include "net/base/host_names.h"
#include "render/gl/context.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

using Problem = std::optional<std::string>;

Problem set_size(Options& options, const std::string& value) {
  options.picture.paper = read_paper(value);
  if (options.picture.paper) return {};
  double size[2];
  if (!read_list(value, 'x', size) || size[0] < 1 || size[1] < 1 || size[0] > kMostPictureSide ||
      size[1] > kMostPictureSide)
    return "expected WIDTHxHEIGHT in pixels, each from 1 to 65536, or with mm, cm or in behind it: 210x297mm";
  options.size_given = true;
  options.width = static_cast<int>(size[0]);
  options.height = static_cast<int>(size[1]);
  return {};
}

// Sets the image. The name may lack an extension, as desktops request for thumbnails.
Problem set_snapshot(Options& options, const std::string& value) {
  options.snapshot = value;
  const std::string extension = lower_case(std::filesystem::path(value).extension().string());
  if (value.empty()) return "expected a file";
  return extension.empty() || extension == ".png" ? Problem{}
                                                  : "pictures are written as PNG: expected a name that ends in .png";
}

Problem set_samples(Options& options, const std::string& value) {
  return read(value, options.samples) && options.samples >= 1 && options.samples <= 64 ? Problem{} : "expected 1 to 64";
}

Problem set_orbit(Options& options, const std::string& value) {
  double angles[2];
  if (!read_list(value, ',', angles)) return "expected AZIMUTH,ELEVATION in degrees";
  options.orbit = {angles[0], angles[1]};
  return {};
}

Problem set_layout(Options& options, const std::string& value) {
  auto read = read_split(value);
  if (auto* problem = std::get_if<std::string>(&read)) return "expected a split such as '1:2|(2/3)': " + *problem;
  options.layout = std::move(std::get<SplitTree>(read));
  return {};
}

Problem set_max_bytes(Options& options, const std::string& value) {
  options.max_bytes_given = true;
  return read_bytes(value, options.max_bytes) ? Problem{} : std::string(kExpectedBytes);
}

Problem set_backend(Options& options, const std::string& value) {
  const auto known = render::headless_backends();
  if (value != "auto" && value != "glfw" && std::find(known.begin(), known.end(), value) == known.end()) {
    std::string names = "expected auto, glfw";
    for (const std::string_view name : known) names += ", " + std::string(name);
    return names;
  }
  options.backend = value;
  return {};
}

Problem set_headlight(Options& options, const std::string& value) {
  if (value != "on" && value != "off") return "expected on or off";
  options.headlight = value == "on";
  return {};
}

// Parses simulated time. The limit is a day, more than five million steps.
Problem set_seconds(double& seconds, const std::string& value) {
  constexpr double kLongest = 86400;
  return read(value, seconds) && seconds >= 0 && seconds <= kLongest ? Problem{} : "expected seconds, from 0 to 86400";
}

Problem set_until(Options& options, const std::string& value) {
  double seconds = 0;
  const Problem problem = set_seconds(seconds, value);
  options.until = seconds;
  return problem;
}

Problem set_splats(Options& options, const std::string& value) {
  if (value != "auto" && value != "gl" && value != "cpu") return "expected auto, gl or cpu";
  options.splats = value;
  return {};
}

Problem set_budget(Options& options, const std::string& value) {
  return read_count(value, options.budget) && options.budget > 0 ? Problem{}
                                                                 : "expected a number of vectors, more than 0";
}

Problem set_loss(Options& options, const std::string& value) {
  const std::size_t colon = value.find(':');
  const bool good = read(std::string_view(value).substr(0, colon), options.loss) && options.loss >= 0 &&
                    options.loss <= 1 &&
                    (colon == std::string::npos || read(std::string_view(value).substr(colon + 1), options.loss_seed));
  return good ? Problem{} : "expected a share from 0 to 1, with :SEED behind it where it matters which";
}

Problem set_allowed(Options& options, const std::string& value) {
  std::error_code error;
  if (!std::filesystem::exists(value, error)) return "expected a folder that is there";
  options.allowed.push_back(value);
  return {};
}

Problem set_timeout(Options& options, const std::string& value) {
  options.timeout_given = true;
  return read(value, options.timeout_seconds) && options.timeout_seconds > 0 ? Problem{}
                                                                             : "expected seconds, more than 0";
}

Problem set_memory(Options& options, const std::string& value) {
  constexpr std::uint64_t kLeast = std::uint64_t{16} << 20, kMost = std::uint64_t{1} << 46;
  std::uint64_t bytes = 0;
  if (!read_bytes(value, bytes) || bytes > kMost || bytes < kLeast)
    return "expected a number of bytes, or with K, M or G behind it, from 16M on";
  options.limits.memory = bytes;
  return {};
}

Problem set_port(std::optional<std::uint16_t>& port, const std::string& value) {
  std::uint16_t number = 0;
  if (!read(value, number)) return "expected a port, 0 (any free one) to 65535";
  port = number;
  return {};
}

Problem set_control(Options& options, const std::string& value) {
  std::optional<std::uint16_t> port;
  if (value.find_first_not_of("0123456789") == std::string::npos) {
    const Problem problem = set_port(port, value);
    if (!problem) options.control_ports.push_back(*port);
    return problem;
  }
  options.control_paths.push_back(value);
  return {};
}

Problem set_rate(Options& options, const std::string& value) {
  return read_count(value, options.rate) && options.rate > 0
             ? Problem{}
             : "expected bits a second, more than 0, or with k, M or G behind the number: 200k";
}

Problem set_congestion(Options& options, const std::string& value) {
  std::string names;
  for (const net::CongestionName& row : net::congestion_names()) {
    if (row.name == value) {
      options.congestion = row.response;
      return {};
    }
    names += (names.empty() ? "expected " : ", ") + std::string(row.name);
  }
  return names;
}

Problem set_host_names(Options& options, const std::string& value) {
  const bool good = each_of(value, [&](const std::string& name) {
    options.host_names.push_back(name);
    return net::host_of(name) || net::ip_address_of(name);
  });
  return good ? Problem{} : "expected names as they stand in URLs, parted by commas";
}

Problem set_origins(Options& options, const std::string& value) {
  const bool good = each_of(value, [&](const std::string& origin) {
    options.origins.push_back(origin);
    if (origin == "*") return true;
    const std::size_t host = origin.find("://");
    return host != std::string::npos && host > 0 && net::host_of(std::string_view(origin).substr(host + 3)).has_value();
  });
  return good ? Problem{} : "expected * or origins like https://example.org, parted by commas";
}

Problem set_proxies(Options& options, const std::string& value) {
  const bool good = each_of(value, [&](const std::string& text) {
    const auto block = net::address_block_of(text);
    if (block) options.proxies.push_back(*block);
    return block.has_value();
  });
  return good ? Problem{} : "expected addresses or blocks of them like 10.0.0.0/8, parted by commas";
}

constexpr OptionRow kOptions[] = {
    {"--snapshot", "OUT.png", "", "write a picture without opening a window, and exit", "open ", set_snapshot},
    {"--size", "WxH", "1024x768",
     "size of the picture or the window in pixels; of a picture also in mm, cm or in: 210x297mm", "open animate trace ",
     set_size},
    {"--time", "SECONDS", "0",
     "the picture after so much simulated time, in steps of at most 1/60 s; the simulated clock begins at 946684800, "
     "which is 2000-01-01T00:00:00Z",
     "open ", [](Options& o, const std::string& v) { return set_seconds(o.time, v); }},
    {"--until", "SECONDS", "", "end after so much simulated time", "trace ", set_until},
    {"--sound", "FILE.wav", "", "write what is heard meanwhile, at most an hour of it", "open trace ",
     [](Options& o, const std::string& v) {
       o.sound = v;
       return Problem{};
     }},
    {"--mute", "", "", "no sound in a window, until M asks for it", "open ",
     [](Options& o, const std::string&) {
       o.muted = true;
       return Problem{};
     }},
    {"--reuse", "", "", "open the files in the window that is there already, if there is one: for desktops", "open ",
     [](Options& o, const std::string&) {
       o.reuse = true;
       return Problem{};
     }},
    {"--config", "FILE", "",
     "keep the settings of a window in FILE, in the place of ~/.config/ghostspace/settings.conf", "open ",
     [](Options& o, const std::string& v) {
       o.config = v;
       return v.empty() ? Problem("expected a file") : Problem{};
     }},
    {"--no-config", "", "",
     "a window reads and writes nothing of yours: no settings, bookmarks, recent files or log. So it is anyway for "
     "pictures, and where the program is controlled",
     "open ",
     [](Options& o, const std::string&) {
       o.no_config = true;
       return Problem{};
     }},
    {"--input", "FILE", "",
     "what somebody does meanwhile: JSON lines in the order of time, such as {\"t\":3,\"viewpoint\":\"NAME\"}, which "
     "binds a Viewpoint, {\"t\":4,\"set\":\"DEF.eventIn\",\"value\":\"1 0 0\"}, which sends an event, and "
     "{\"t\":5,\"move\":[X,Y]}, press or release in the place of move, which points at a pixel of --size, from the "
     "upper left, with the left button; {\"t\":6,\"press\":\"NAME\"}, which presses a sensor by its DEF name or "
     "Type#number wherever it is, then {\"t\":7,\"drag\":[X,Y]} by pixels and {\"t\":8,\"release\":true}; "
     "{\"t\":9,\"viewer\":[X,Y,Z]}, which takes the viewer there",
     "open trace ",
     [](Options& o, const std::string& v) {
       o.input = v;
       return Problem{};
     }},
    {"--press-sensors", "", "",
     "somebody tries everything meanwhile: presses, drags and releases each pointing-device sensor and Anchor, "
     "whatever "
     "lies before it, and goes to each ProximitySensor; a line at the end says how many",
     "open trace ",
     [](Options& o, const std::string&) {
       o.press_sensors = true;
       return Problem{};
     }},
    {"--control", "PATH|PORT", "",
     "let other programs of this machine control it: JSON-RPC over a Unix socket that is made at PATH, or over "
     "WebSockets on PORT (0: any free one) of 127.0.0.1; may be given several times. They must know a token. With "
     "--backend osmesa or egl there is no window, and it runs until it is told to end",
     "open ", set_control, true},
    {"--control-token", "FILE", "",
     "write the token for --control into FILE, which only its owner may read, and not to standard error", "open ",
     [](Options& o, const std::string& v) {
       o.control_token = v;
       return v.empty() ? Problem("expected a file") : Problem{};
     }},
    {"--samples", "N", "4", "anti-aliasing: samples a pixel", "open animate ", set_samples},
    {"--viewpoint", "NAME|N", "", "start at the Viewpoint of this description, DEF name or number (from 1)",
     "open animate ",
     [](Options& o, const std::string& v) {
       o.viewpoint = v;
       return Problem{};
     }},
    {"--layout", "SPLIT", "",
     "how the viewports share the window: their numbers from 1, which are those of the files, '|' between those beside "
     "each other, '/' between those above each other, brackets, ':N' behind one that is N times as large: '1:2|(2/3)'",
     "open ", set_layout},
    {"--orbit", "AZ,EL", "", "look at the whole scene from this azimuth and elevation in degrees; 0,0 is from +Z",
     "open animate ", set_orbit},
    {"--headlight", "on|off", "", "in place of what the world says", "open animate ", set_headlight},
    {"--backend", "auto|glfw|egl|osmesa", "auto", "where to draw", "open animate ", set_backend},
    {"--splats", "auto|gl|cpu", "auto", "where the discs of clouds are drawn", "open animate ", set_splats},
    {"--budget", "VECTORS", "", "draw no more vectors than this in a viewport", "open animate ", set_budget},
    {"--loss", "P[:SEED]", "", "drop this share of a stream's packets, as if they had never come", "open fetch ",
     set_loss},
    {"--max-bytes", "SIZE", "",
     "take only so many bytes of the file, as if the rest had not arrived; encode: write at most so many. Bytes, or "
     "with K, M or G behind the number: 400k",
     "open check info encode fetch trace ", set_max_bytes},
};

constexpr OptionRow kOtherOptions[] = {
    {"--json", "", "", "machine-readable", "info encode fetch ",
     [](Options& o, const std::string&) {
       o.json = true;
       return Problem{};
     }},
    {"--timeout", "SECONDS", "30",
     "for loading; what has not come by then is left out. Drawing a snapshot may take as long again. A window "
     "waits for ever unless this is given",
     "open animate check print info encode export fetch trace ", set_timeout},
    {"--memory", "SIZE", "2G",
     "about so much memory may be taken for one world (bytes, or with K, M or G behind the number); what would take "
     "more "
     "is left out, and a message names the limit",
     "open animate check print info encode export fetch trace ", set_memory},
    {"--offline", "", "", "read nothing over the network", "open animate check print info encode export trace ",
     [](Options& o, const std::string&) {
       o.offline = true;
       return Problem{};
     }},
    {"--allow-network", "", "", "let Scripts that have read other local files use the network without a question",
     "open animate trace ",
     [](Options& o, const std::string&) {
       o.allow_network = true;
       return Problem{};
     }},
    {"--allow", "FOLDER", "",
     "a world of this machine may read files of this folder and below it, too, and not only of its own; may be given "
     "several times",
     "open animate check print info encode export fetch trace ", set_allowed, true},
    {"--confine", "FOLDER", "",
     "for files of strangers: the kernel lets it read nothing but FOLDER and the system's libraries, write nothing but "
     "into the folder of OUT, and open no connection (Landlock and seccomp, where the kernel has them)",
     "open check print info encode export trace ",
     [](Options& o, const std::string& v) {
       o.confine = v;
       o.offline = true;
       return v.empty() ? Problem("expected a folder") : Problem{};
     }},
    {"--http", "PORT", "8080", "serve by HTTP on this port; 0: any free one. Not if only --cells is given", "serve ",
     [](Options& o, const std::string& v) { return set_port(o.http_port, v); }},
    {"--cells", "PORT", "", "serve streams as ATM cells in UDP on this port", "serve ",
     [](Options& o, const std::string& v) { return set_port(o.cells_port, v); }},
    {"--bind", "ADDRESS|*", "127.0.0.1", "which of this machine's addresses to listen at; *: all", "serve ",
     [](Options& o, const std::string& v) {
       o.bind = v;
       return Problem{};
     }},
    {"--host", "NAME,...", "",
     "names that the server goes by besides localhost and its address: listening at 127.0.0.1 or another address of "
     "this "
     "machine alone it answers for no others, lest pages of foreign sites read it (DNS rebinding)",
     "serve ", set_host_names},
    {"--cors", "ORIGIN,...|*", "none, all with --bind",
     "pages of which sites may read what is served; all may where it is served to others than this machine", "serve ",
     set_origins},
    {"--proxies", "ADDRESS,...", "",
     "proxies in front of the server, by addresses or blocks (10.0.0.0/8): their X-Forwarded-For is believed, so that "
     "the "
     "limits of one address are for their clients and not for them",
     "serve ", set_proxies},
    {"--rate", "BIT/S", "",
     "serve: all clients together get no more than this; else: ask servers of cells for this, and take no faster from "
     "others; in a window for each viewport, where it can be changed",
     "serve open fetch ", set_rate},
    {"--congestion", "NAME", "equation",
     "how cells answer to losses: equation (as TCP would), delay-aware (only losses that came with a queue count: for "
     "links that lose by themselves) or reserved (none: for paths on which the rate is reserved)",
     "serve ", set_congestion},
    {"--cache", "FOLDER", "", "where thumbnails and streams that were made are kept", "serve ",
     [](Options& o, const std::string& v) {
       o.cache = v;
       return Problem{};
     }},
    {"--log", "FILE", "-", "the access log; - is standard output", "serve ",
     [](Options& o, const std::string& v) {
       o.log = v;
       return Problem{};
     }},
    {"--scripts", "", "", "compile the programs of Scripts as well", "check ",
     [](Options& o, const std::string&) {
       o.scripts = true;
       return Problem{};
     }},
    {"--stats", "FILE.json", "",
     "write measurements of the run: seconds of its phases, bytes, triangles, memory; - is standard output",
     "open check ",
     [](Options& o, const std::string& v) {
       o.stats = v;
       return Problem{};
     }},
    {"--markdown", "", "", "as Markdown tables", "nodes ",
     [](Options& o, const std::string&) {
       o.markdown = true;
       return Problem{};
     }},
    {"--wrl", "", "", "as PROTO declarations (the default)", "nodes ",
     [](Options& o, const std::string&) {
       o.wrl = true;
       return Problem{};
     }},
};

}  // namespace

std::span<const OptionRow> option_rows() {
  static const std::vector<OptionRow> all = [] {
    std::vector<OptionRow> rows;
    for (const std::span<const OptionRow> part : {std::span<const OptionRow>(kOptions), encode_option_rows(),
                                                  std::span<const OptionRow>(kOtherOptions), picture_option_rows()})
      rows.insert(rows.end(), part.begin(), part.end());
    return rows;
  }();
  return all;
}

}  // namespace gs::app
