use super::{Constant, Flow, Instruction, PC, Stack, decode, it_block};

const AT: u32 = 0x0800_1000;

fn wide(first: u16, second: u16) -> Instruction {
    decode(AT, first, Some(second))
}

fn narrow(code: u16) -> Instruction {
    decode(AT, code, None)
}

#[test]
fn lengths() {
    assert_eq!(narrow(0xBF00).length, 2);
    assert_eq!(narrow(0xE7FE).length, 2);
    for first in [0xE800, 0xE92D, 0xEE00, 0xF000, 0xF8DF, 0xFFFF] {
        assert_eq!(wide(first, 0x8000).length, 4);
    }
}

#[test]
fn branches() {
    for (code, flow) in [
        (0xE7FE, Flow::Jump(AT)),
        (0xE001, Flow::Jump(AT + 6)),
        (0xD0FE, Flow::Branch(AT)),
        (0xDD7F, Flow::Branch(AT + 4 + 254)),
        (0xB100, Flow::Branch(AT + 4)),
        (0xBBFF, Flow::Branch(AT + 4 + 126)),
        (0x4770, Flow::Return),
        (0x4718, Flow::JumpRegister(3)),
        (0x47A8, Flow::CallRegister(5)),
        (0x46F7, Flow::Return),
        (0x4687, Flow::JumpRegister(0)),
        (0x4487, Flow::Computed),
        (0xDE01, Flow::Undefined),
        (0xBE00, Flow::Breakpoint),
        (0xDF00, Flow::Next),
        (0xBF30, Flow::Next),
    ] {
        assert_eq!(narrow(code).flow, flow, "{code:#06x}");
    }
    for (first, second, flow) in [
        (0xF000, 0xF800, Flow::Call(AT + 4)),
        (0xF7FF, 0xFFFE, Flow::Call(AT)),
        (0xF000, 0x9000, Flow::Jump(AT + 4 + 0xC0_0000)),
        (0xF000, 0xB800, Flow::Jump(AT + 4)),
        (0xF43F, 0xAFFE, Flow::Branch(AT)),
        (0xF340, 0x8000, Flow::Branch(AT + 4)),
        (0xF7F0, 0xA000, Flow::Undefined),
        (0xF3BF, 0x8F4F, Flow::Next),
        (
            0xE8DF,
            0xF003,
            Flow::Table {
                wide: false,
                base: PC,
            },
        ),
        (
            0xE8DF,
            0xF013,
            Flow::Table {
                wide: true,
                base: PC,
            },
        ),
        (0xE8BD, 0x8010, Flow::Return),
        (0xE890, 0x8010, Flow::Computed),
        (0xF85D, 0xFB04, Flow::Return),
        (0xF8DF, 0xF008, Flow::JumpLiteral(AT + 12)),
        (0xF852, 0xF023, Flow::Computed),
        (0xF89F, 0xF000, Flow::Next),
    ] {
        assert_eq!(wide(first, second).flow, flow, "{first:#06x} {second:#06x}");
    }
}

#[test]
fn the_stack_pointer() {
    for (code, stack) in [
        (0xB5F0, Stack::Down(20)),
        (0xBDF0, Stack::Up(20)),
        (0xB082, Stack::Down(8)),
        (0xB002, Stack::Up(8)),
        (0x46A5, Stack::Dynamic),
        (0xA802, Stack::Same),
        (0x9001, Stack::Same),
    ] {
        assert_eq!(narrow(code).stack, stack, "{code:#06x}");
    }
    for (first, second, stack) in [
        (0xE92D, 0x4FF0, Stack::Down(36)),
        (0xE8BD, 0x8FF0, Stack::Up(36)),
        (0xED2D, 0x8B10, Stack::Down(64)),
        (0xED2D, 0x8A01, Stack::Down(4)),
        (0xECBD, 0x8B10, Stack::Up(64)),
        (0xF5AD, 0x7D00, Stack::Down(512)),
        (0xF5AD, 0x5D80, Stack::Down(4096)),
        (0xF50D, 0x7D00, Stack::Up(512)),
        (0xF2AD, 0x4D04, Stack::Down(0x404)),
        (0xF20D, 0x4D04, Stack::Up(0x404)),
        (0xF84D, 0x8D04, Stack::Down(4)),
        (0xF85D, 0x8B04, Stack::Up(4)),
        (0xE96D, 0x0102, Stack::Down(8)),
        (0xEBAD, 0x0D00, Stack::Dynamic),
        (0xF1A7, 0x0D18, Stack::Dynamic),
        (0xF380, 0x8808, Stack::Dynamic),
        (0xF8CD, 0x0010, Stack::Same),
        (0xF1BD, 0x0F00, Stack::Same),
    ] {
        assert_eq!(
            wide(first, second).stack,
            stack,
            "{first:#06x} {second:#06x}"
        );
    }
}

#[test]
fn constants_and_what_may_be_written() {
    assert_eq!(wide(0xF241, 0x2334).constant, Constant::Low(3, 0x1234));
    assert_eq!(wide(0xF6C0, 0x0300).constant, Constant::High(3, 0x0800));
    assert_eq!(narrow(0x4B01).constant, Constant::Literal(3, AT + 8));
    let from_far = wide(0xF8DF, 0xC010);
    assert_eq!(from_far.constant, Constant::Literal(12, AT + 4 + 16));
    assert_eq!(narrow(0x461C).constant, Constant::Copy { to: 4, from: 3 });
    assert_eq!(narrow(0xBC0F).may_write & 0xF, 0xF);
    // umull r2, r5, r0, r1
    assert_eq!(wide(0xFBA0, 0x2501).may_write & 0x24, 0x24);
}

#[test]
fn the_fpu_is_seen() {
    assert!(wide(0xEE30, 0x0A01).fpu);
    assert!(wide(0xED9F, 0x0A03).fpu);
    assert!(!wide(0xEE07, 0x0F90).fpu);
    assert!(!wide(0xF000, 0xF800).fpu);
}

#[test]
fn it_blocks() {
    for (code, length) in [
        (0xBF08, 1),
        (0xBF0C, 2),
        (0xBF0A, 3),
        (0xBF01, 4),
        (0xBF00, 0),
    ] {
        assert_eq!(it_block(code), length, "{code:#06x}");
    }
    assert_eq!(it_block(0xB408), 0);
}
