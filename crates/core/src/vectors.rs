//! Loops compiled twice: for what every processor has, and for AVX2.

/// A function whose loops are also compiled for AVX2, and that runs so where the processor has it, to bit-identical results: nothing is contracted or
/// reordered. Constants that it is generic over stand in brackets after its name; what it calls must be inlined to gain.
///
/// ```
/// scaleproof_core::by_avx2! {
///     /// Adds up.
///     pub fn sums[const N: usize](rows: &[[i32; N]]) -> [i32; N] {
///         rows.iter().fold([0; N], |sums, row| std::array::from_fn(|i| sums[i] + row[i]))
///     }
/// }
/// assert_eq!(sums(&[[1, 2], [3, 4]]), [4, 6]);
/// ```
#[macro_export]
macro_rules! by_avx2 {
    ($(#[$meta:meta])* $visibility:vis fn $name:ident $([$(const $constant:ident: $of_constant:ty),+])? ($($argument:ident: $of:ty),* $(,)?) $(-> $result:ty)? $body:block) => {
        $(#[$meta])*
        $visibility fn $name $(<$(const $constant: $of_constant),+>)? ($($argument: $of),*) $(-> $result)? {
            #[inline(always)]
            fn plain $(<$(const $constant: $of_constant),+>)? ($($argument: $of),*) $(-> $result)? $body

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2")]
            fn with_avx2 $(<$(const $constant: $of_constant),+>)? ($($argument: $of),*) $(-> $result)? {
                plain$(::<$($constant),+>)?($($argument),*)
            }

            #[cfg(target_arch = "x86_64")]
            if ::std::is_x86_feature_detected!("avx2") {
                // SAFETY: the processor has the instructions.
                return unsafe { with_avx2$(::<$($constant),+>)?($($argument),*) };
            }
            plain$(::<$($constant),+>)?($($argument),*)
        }
    };
}
