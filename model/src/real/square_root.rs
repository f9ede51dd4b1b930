//! √x in f32, correctly rounded: the core's own instruction where it has one
//! that `libm` does not use, the same bits by `libm` elsewhere.
#![allow(unsafe_code, reason = "an instruction without a name in `core`")]

/// √x; NaN below zero.
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
#[inline]
pub(super) fn square_root(x: f32) -> f32 {
    /// Computes √x by the core's instruction: with the hard-float ABI a number comes and goes in `s0`.
    ///
    /// # Safety
    /// The core has `s0`, which this ABI says.
    #[unsafe(naked)]
    unsafe extern "C" fn vsqrt(x: f32) -> f32 {
        core::arch::naked_asm!(".fpu fpv4-sp-d16", "vsqrt.f32 s0, s0", "bx lr")
    }
    // SAFETY: only compiled for the hard-float ABI.
    unsafe { vsqrt(x) }
}

/// √x; NaN below zero.
#[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
#[inline]
pub(super) fn square_root(x: f32) -> f32 {
    libm::sqrtf(x)
}
