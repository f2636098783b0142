// Debian's libfmt.so is built by g++, whose mangled name for this one template of fmt 9 is not clang's: it is
// compiled here, as fmt's own format.cc does.
#include <fmt/format-inl.h>

FMT_BEGIN_NAMESPACE
namespace detail {
template void vformat_to(buffer<char>&, string_view, basic_format_args<FMT_BUFFER_CONTEXT(char)>, locale_ref);
}
FMT_END_NAMESPACE
