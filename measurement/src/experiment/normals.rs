//! Standard normal numbers of one stream.

use rand_distr::{Distribution, StandardNormal};

use crate::seed::Stream;

/// Numbers that are drawn at once: a loop alone draws faster than calls between other work.
const TOGETHER: usize = 64;

/// The numbers that the stream gives one by one, in their order.
#[derive(Clone, Debug)]
pub(super) struct Normals {
    stream: Stream,
    drawn: [f64; TOGETHER],
    next: usize,
}

impl Normals {
    pub(super) const fn new(stream: Stream) -> Self {
        Self { stream, drawn: [0.0; TOGETHER], next: TOGETHER }
    }

    #[inline]
    pub(super) fn draw(&mut self) -> f64 {
        let Some(&number) = self.drawn.get(self.next) else {
            self.draw_anew();
            self.next = 1;
            return self.drawn[0];
        };
        self.next += 1;
        number
    }

    #[inline(never)]
    fn draw_anew(&mut self) {
        for number in &mut self.drawn {
            *number = StandardNormal.sample(&mut self.stream);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::seed::Seed;

    #[test]
    fn identity_numbers_are_those_of_the_stream_one_by_one() {
        let mut stream = Seed::new(1).stream("normals", 2);
        let mut normals = Normals::new(stream.clone());
        for _ in 0..3 * TOGETHER / 2 {
            let expected: f64 = StandardNormal.sample(&mut stream);
            assert_eq!(normals.draw(), expected);
        }
    }
}
