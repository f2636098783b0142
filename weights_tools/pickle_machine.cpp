#include "weights_tools/pickle_machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "nn/base/error.h"
#include "nn/base/text.h"
#include "weights_tools/byte_reader.h"
#include "weights_tools/pickle_calls.h"
#include "weights_tools/pickle_globals.h"
#include "weights_tools/pickle_opcodes.h"
#include "weights_tools/pickle_stack.h"

namespace penumbra::weights_tools {

namespace {

constexpr std::size_t kLongestGlobalName = 256;
constexpr std::string_view kNeededOperation = "a pickle operation that state dicts need";
constexpr int kNewestProtocol = 5;

class PickleMachine {
 public:
  PickleMachine(std::span<const std::byte> bytes, std::size_t begin, const std::string& place)
      : heap_(place), reader_(bytes, begin, [this](std::uint64_t needed) { fail_at_end(needed); }) {}

  PickledObject run() {
    while (!stopped_) {
      heap_.set_position(reader_.position());
      step(reader_.number<std::uint8_t>());
    }
    heap_.object().root = stack_.pop();
    heap_.object().end = reader_.position();
    return std::move(heap_.object());
  }

 private:
  void step(std::uint8_t opcode) {
    switch (static_cast<Opcode>(opcode)) {
      case Opcode::kProto:
        return check_protocol();
      case Opcode::kFrame:  // announces how much the next operations take; they check for themselves
        reader_.number<std::uint64_t>();
        return;
      case Opcode::kStop:
        stopped_ = true;
        return;

      case Opcode::kMark:
        return stack_.mark();
      case Opcode::kPop:
        stack_.pop();
        return;
      case Opcode::kPopMark:
        return stack_.drop_to(stack_.pop_mark());

      case Opcode::kNone:
        return push({.kind = ValueKind::none});
      case Opcode::kNewTrue:
        return push({.kind = ValueKind::boolean, .number = 1});
      case Opcode::kNewFalse:
        return push({.kind = ValueKind::boolean, .number = 0});
      case Opcode::kBinInt:
        return push_integer(reader_.number<std::int32_t>());
      case Opcode::kBinInt1:
        return push_integer(reader_.number<std::uint8_t>());
      case Opcode::kBinInt2:
        return push_integer(reader_.number<std::uint16_t>());
      case Opcode::kLong1:
        return push_long(reader_.text(reader_.number<std::uint8_t>()));
      case Opcode::kLong4:  // its length is signed: a negative one is beyond the end
        return push_long(reader_.text(reader_.number<std::uint32_t>()));
      case Opcode::kBinFloat:
        return push_real();

      case Opcode::kBinString:  // Python 2's str
      case Opcode::kBinUnicode:
        return push_text(reader_.number<std::uint32_t>());
      case Opcode::kShortBinString:
      case Opcode::kShortBinUnicode:
        return push_text(reader_.number<std::uint8_t>());
      case Opcode::kBinUnicode8:
        return push_text(reader_.number<std::uint64_t>());
      case Opcode::kBinBytes:
        return push({.kind = ValueKind::bytes, .text = reader_.text(reader_.number<std::uint32_t>())});
      case Opcode::kShortBinBytes:
        return push({.kind = ValueKind::bytes, .text = reader_.text(reader_.number<std::uint8_t>())});

      case Opcode::kBinBytes8:
      case Opcode::kByteArray8:
        return push({.kind = ValueKind::bytes, .text = reader_.text(reader_.number<std::uint64_t>())});

      case Opcode::kEmptyTuple:
        return push({.kind = ValueKind::tuple});
      case Opcode::kTuple:
        return stack_.push_tuple(stack_.pop_mark());
      case Opcode::kTuple1:
        return stack_.push_tuple(stack_.below_top(1));
      case Opcode::kTuple2:
        return stack_.push_tuple(stack_.below_top(2));
      case Opcode::kTuple3:
        return stack_.push_tuple(stack_.below_top(3));

      case Opcode::kEmptyList:
        return push({.kind = ValueKind::list});
      case Opcode::kAppend:
        return stack_.append_from(stack_.below_top(1), ValueKind::list);
      case Opcode::kAppends:
        return stack_.append_from(stack_.pop_mark(), ValueKind::list);
      case Opcode::kEmptyDict:
        return push({.kind = ValueKind::dict});
      case Opcode::kSetItem:
        return stack_.append_from(stack_.below_top(2), ValueKind::dict);
      case Opcode::kSetItems:
        return stack_.append_from(stack_.pop_mark(), ValueKind::dict);
      case Opcode::kEmptySet:
        return push({.kind = ValueKind::set});
      case Opcode::kAddItems:
        return stack_.append_from(stack_.pop_mark(), ValueKind::set);
      case Opcode::kFrozenSet: {
        stack_.push_tuple(stack_.pop_mark());
        heap_[stack_.top()].kind = ValueKind::set;
        return;
      }

      case Opcode::kBinPut:
        return put(reader_.number<std::uint8_t>());
      case Opcode::kLongBinPut:
        return put(reader_.number<std::uint32_t>());
      case Opcode::kMemoize:
        return put(memo_.size());
      case Opcode::kBinGet:
        return stack_.push(memo_.get(reader_.number<std::uint8_t>()));
      case Opcode::kLongBinGet:
        return stack_.push(memo_.get(reader_.number<std::uint32_t>()));

      case Opcode::kGlobal: {
        const std::string_view module = reader_.line(kLongestGlobalName);
        return push_global(module, reader_.line(kLongestGlobalName));
      }
      case Opcode::kStackGlobal: {
        const std::string_view name = stack_.pop_text("a global's name");
        return push_global(stack_.pop_text("a global's module"), name);
      }
      case Opcode::kReduce:
      case Opcode::kNewObj: {
        const ValueId arguments = stack_.pop(), function = stack_.pop();
        return stack_.push(call(heap_, function, arguments));
      }
      case Opcode::kNewObjEx: {
        stack_.pop();  // arguments by name, which no object keeps
        const ValueId arguments = stack_.pop(), function = stack_.pop();
        return stack_.push(call(heap_, function, arguments));
      }
      case Opcode::kBuild:
        return build();
      case Opcode::kInst: {  // of protocol 0: read to say what it would have made
        const std::string_view module = reader_.line(kLongestGlobalName);
        const std::string_view name = reader_.line(kLongestGlobalName);
        allowed_global(module, name);
        heap_.fail(kNeededOperation, fmt::format("INST of {}.{} (protocol 0; nothing was executed)",
                                                 printable(module), printable(name)));
      }
      case Opcode::kPersId:
        heap_.fail(kNeededOperation, fmt::format("PERSID '{}' (protocol 0; nothing was executed)",
                                                 printable(reader_.line(kLongestGlobalName))));
      case Opcode::kBinPersId:
        return stack_.push(find_storage(heap_, stack_.pop()));
    }
    heap_.fail(kNeededOperation,
               fmt::format("opcode 0x{:02x} '{}' (nothing was executed)", opcode,
                           printable(std::string_view(reinterpret_cast<const char*>(&opcode), 1))));
  }

  [[noreturn]] void fail_at_end(std::uint64_t needed) const {
    heap_.fail(fmt::format("an operation that needs {} more bytes", needed),
               fmt::format("{} bytes to the end (truncated or damaged)", reader_.remaining()));
  }

  void check_protocol() {
    const int protocol = reader_.number<std::uint8_t>();
    if (protocol > kNewestProtocol) {
      heap_.fail(fmt::format("a pickle protocol up to {}", kNewestProtocol), fmt::format("{}", protocol));
    }
  }

  void push(Value value) { stack_.push(heap_.add(std::move(value))); }
  void push_integer(std::int64_t number) { push({.kind = ValueKind::integer, .number = number}); }
  void push_text(std::uint64_t length) { push({.kind = ValueKind::text, .text = reader_.text(length)}); }

  // Two's complement, little-endian, any number of bytes.
  void push_long(std::string_view bytes) {
    if (bytes.size() > 8) return push({.kind = ValueKind::bytes, .text = bytes});
    std::uint64_t number = 0;
    for (std::size_t i = 0; i < bytes.size(); ++i) {
      number |= static_cast<std::uint64_t>(static_cast<std::uint8_t>(bytes[i])) << (8 * i);
    }
    const bool negative = !bytes.empty() && (static_cast<std::uint8_t>(bytes.back()) & 0x80U) != 0;
    if (negative && bytes.size() < 8) number |= ~std::uint64_t{0} << (8 * bytes.size());
    push_integer(static_cast<std::int64_t>(number));
  }

  // Big-endian, alone among the numbers.
  void push_real() {
    const std::string_view bytes = reader_.text(8);
    std::uint64_t bits = 0;
    for (const char byte : bytes) bits = bits << 8 | static_cast<std::uint8_t>(byte);
    push({.kind = ValueKind::real, .number = static_cast<std::int64_t>(bits)});
  }

  void put(std::size_t index) { memo_.put(index, stack_.top()); }

  void push_global(std::string_view module, std::string_view name) {
    push({.kind = ValueKind::global, .global = allowed_global(module, name), .text = name});
  }

  Global allowed_global(std::string_view module, std::string_view name) const {
    const std::optional<Global> global = find_global(module, name);
    if (!global) {
      heap_.fail("only globals that checkpoints need, such as torch._utils._rebuild_tensor_v2",
                 fmt::format("{}.{} (nothing was executed; {})", printable(module), printable(name),
                             advice_on_refused_global(module, name)));
    }
    return *global;
  }

  void build() {
    const ValueId state = stack_.pop();
    heap_.set_attributes(stack_.top(), state);
  }

  PickleHeap heap_;
  ByteReader reader_;
  PickleStack stack_{heap_};
  PickleMemo memo_{heap_};
  bool stopped_ = false;
};

}  // namespace

PickledObject run_pickle(std::span<const std::byte> bytes, std::size_t begin, const std::string& place) {
  return PickleMachine(bytes.first(std::min(bytes.size(), begin + kLongestPickle)), begin, place).run();
}

}  // namespace penumbra::weights_tools
