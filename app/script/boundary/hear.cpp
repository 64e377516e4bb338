#include "app/script/boundary/hear.h"

namespace gs::app::script {

Heard hear(WorldAccess& world, std::span<const std::byte> message, MessageWriter& answer,
           const std::function<bool(const Report&)>& reported) {
  MessageReader reader(message);
  while (!reader.at_end()) {
    switch (static_cast<ItemKind>(reader.number<std::uint8_t>())) {
      case ItemKind::notice: {
        const Notice notice = read_notice(reader);
        if (!reader.good()) return Heard::impossible;
        world.tell(notice);
        break;
      }
      case ItemKind::question: {
        const Question question = read_question(reader);
        if (!reader.good() || !reader.at_end()) return Heard::impossible;
        answer.clear();
        write(answer, world.ask(question));
        return Heard::question;
      }
      case ItemKind::report: {
        const Report report = read_report(reader);
        if (!reader.good() || !reported(report)) return Heard::impossible;
        break;
      }
      default:
        return Heard::impossible;
    }
  }
  return reader.good() ? Heard::all : Heard::impossible;
}

}  // namespace gs::app::script
