// The vector kernels of one instruction set; compiled once per instruction set with PENUMBRA_ISA set.
namespace penumbra::nn::PENUMBRA_ISA {}
