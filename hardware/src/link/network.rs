//! Keeps packets of other networks away from the middleware.
//!
//! RustDDS 0.15.1 binds its sockets to every address of the machine, whichever networks it is told to use
//! (`dds/participant.rs`), and believes every packet that comes. So each of its sockets gets a filter in the kernel, which
//! drops what has come in by an interface that was not chosen:
//!
//! ```text
//! packet ─→ interface chosen, or the loopback? ─→ socket ─→ middleware
//!                      └─ no: dropped (SO_ATTACH_FILTER)
//! ```
//! The middleware opens its sockets when it joins, so the filters come some milliseconds later. What has come until then is
//! taken out of the sockets. At that time no topic is open, so that no message of another network is ever delivered; only
//! an announcement of a participant may have been read.

use super::{LinkError, Network};

/// The filters of the kernel, where the system has them.
#[cfg(target_os = "linux")]
pub(super) use linux::{allowed, keep_out, sockets};

#[cfg(target_os = "linux")]
mod linux {
    use std::collections::{BTreeMap, BTreeSet};
    use std::io::{IoSlice, IoSliceMut};
    use std::mem::MaybeUninit;
    use std::net::{IpAddr, UdpSocket};
    use std::os::fd::{AsRawFd, OwnedFd, RawFd};
    use std::os::unix::net::UnixDatagram;

    use nix::ifaddrs::getifaddrs;
    use nix::net::if_::{InterfaceFlags, if_nametoindex};
    use nix::sys::socket::{ControlMessage, MsgFlags, SockaddrStorage, sendmsg};
    use rustix::net::{RecvAncillaryBuffer, RecvAncillaryMessage, RecvFlags, recvmsg};
    use socket2::{Domain, SockFilter, SockRef, Type};

    use super::{LinkError, Network};

    fn fault(what: &str, error: &dyn std::fmt::Display) -> LinkError {
        LinkError::Network(format!("{what}: {error}"))
    }

    /// Numbers of the interfaces by which packets may come: the loopback, and those with the addresses of `network`. None
    /// where all may.
    pub(in crate::link) fn allowed(network: &Network) -> Result<Option<BTreeSet<u32>>, LinkError> {
        let chosen: &[IpAddr] = match network {
            Network::Any => return Ok(None),
            Network::Loopback => &[],
            Network::Only(addresses) => addresses,
        };
        let (mut allowed, mut here) = (BTreeSet::new(), BTreeSet::new());
        for interface in getifaddrs().map_err(|error| fault("the addresses of this machine", &error))? {
            let address = interface.address.as_ref().and_then(ip);
            here.extend(address);
            let is_loopback = interface.flags.contains(InterfaceFlags::IFF_LOOPBACK);
            if is_loopback || address.is_some_and(|address| chosen.contains(&address)) {
                let name = interface.interface_name.as_str();
                allowed.insert(if_nametoindex(name).map_err(|error| fault(name, &error))?);
            }
        }
        match chosen.iter().find(|address| !here.contains(address)) {
            Some(address) => {
                Err(LinkError::Network(format!("found {address}, expected addresses of this machine: {here:?}")))
            }
            None => Ok(Some(allowed)),
        }
    }

    fn ip(address: &SockaddrStorage) -> Option<IpAddr> {
        let v4 = address.as_sockaddr_in().map(|address| IpAddr::V4(address.ip()));
        v4.or_else(|| address.as_sockaddr_in6().map(|address| IpAddr::V6(address.ip())))
    }

    /// The sockets of this process: the system's name of each, and its descriptor.
    pub(in crate::link) fn sockets() -> BTreeMap<String, RawFd> {
        let Ok(descriptors) = std::fs::read_dir("/proc/self/fd") else { return BTreeMap::new() };
        let socket = |entry: std::fs::DirEntry| {
            let name = std::fs::read_link(entry.path()).ok()?.to_str()?.to_owned();
            Some((name, entry.file_name().to_str()?.parse().ok()?)).filter(|(name, _)| name.starts_with("socket:"))
        };
        descriptors.flatten().filter_map(socket).collect()
    }

    /// Drops from now on what comes into the sockets of UDP that are not among `before` by another interface than `allowed`.
    ///
    /// # Errors
    /// [`LinkError::Network`] where a socket cannot be found or the kernel refuses: it would be open then.
    pub(in crate::link) fn keep_out(
        allowed: &BTreeSet<u32>,
        before: &BTreeMap<String, RawFd>,
    ) -> Result<(), LinkError> {
        let filter = program(allowed);
        let mut count = 0;
        for (_, descriptor) in sockets().into_iter().filter(|(name, _)| !before.contains_key(name)) {
            let owned = duplicate(descriptor).map_err(|error| fault("a socket of the middleware", &error))?;
            let socket = SockRef::from(&owned);
            let domain = socket.domain().map_err(|error| fault("a socket of the middleware", &error))?;
            let is_datagram = socket.r#type().is_ok_and(|kind| kind == Type::DGRAM);
            if !is_datagram || ![Domain::IPV4, Domain::IPV6].contains(&domain) {
                continue;
            }
            socket.attach_filter(&filter).map_err(|error| fault("the kernel takes no filter", &error))?;
            // What came before the filter; the middleware has set the socket to wait for nothing.
            let socket = UdpSocket::from(owned);
            while socket.recv(&mut [0]).is_ok() {}
            count += 1;
        }
        if count == 0 {
            return Err(LinkError::Network("found no socket of the middleware in /proc/self/fd".to_owned()));
        }
        Ok(())
    }

    /// Passes packets of the allowed interfaces, in the kernel's classic filter language.
    fn program(allowed: &BTreeSet<u32>) -> Vec<SockFilter> {
        const LOAD_WORD: u16 = 0x20;
        const JUMP_IF_EQUAL: u16 = 0x15;
        const RETURN: u16 = 0x06;
        /// SKF_AD_OFF + SKF_AD_IFINDEX: the number of the interface by which the packet has come.
        const INTERFACE: u32 = 0xffff_f000 + 8;
        let mut program = vec![SockFilter::new(LOAD_WORD, 0, 0, INTERFACE)];
        for index in allowed {
            program.push(SockFilter::new(JUMP_IF_EQUAL, 0, 1, *index));
            program.push(SockFilter::new(RETURN, 0, 0, u32::MAX));
        }
        program.push(SockFilter::new(RETURN, 0, 0, 0));
        program
    }

    /// Another descriptor of the same open socket, which belongs to us: passed to ourselves by a pair of sockets.
    fn duplicate(descriptor: RawFd) -> std::io::Result<OwnedFd> {
        let (ours, theirs) = UnixDatagram::pair()?;
        let rights = [ControlMessage::ScmRights(&[descriptor])];
        sendmsg::<()>(ours.as_raw_fd(), &[IoSlice::new(b".")], &rights, MsgFlags::empty(), None)?;
        let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(1))];
        let mut received = RecvAncillaryBuffer::new(&mut space);
        recvmsg(&theirs, &mut [IoSliceMut::new(&mut [0])], &mut received, RecvFlags::CMSG_CLOEXEC)?;
        let owned = received.drain().find_map(|message| match message {
            RecvAncillaryMessage::ScmRights(mut descriptors) => descriptors.next(),
            _ => None,
        });
        owned.ok_or_else(|| std::io::Error::other("it was not passed on"))
    }
}

#[cfg(not(target_os = "linux"))]
mod other {
    use super::{LinkError, Network};

    pub(in crate::link) fn allowed(network: &Network) -> Result<Option<()>, LinkError> {
        match network {
            Network::Any => Ok(None),
            _ => Err(LinkError::Network(format!(
                "found {network:?}, expected \"any\": on this system the middleware cannot be kept to one network"
            ))),
        }
    }

    pub(in crate::link) fn sockets() {}

    pub(in crate::link) fn keep_out((): &(), (): &()) -> Result<(), LinkError> {
        Ok(())
    }
}
#[cfg(not(target_os = "linux"))]
pub(super) use other::{allowed, keep_out, sockets};

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn an_address_that_this_machine_does_not_have_is_named() {
        assert_eq!(allowed(&Network::Any).unwrap(), None);
        let loopback = allowed(&Network::Loopback).unwrap().unwrap();
        assert_eq!(allowed(&Network::Only(vec!["127.0.0.1".parse().unwrap()])).unwrap().unwrap(), loopback);
        let fault = allowed(&Network::Only(vec!["192.0.2.7".parse().unwrap()])).unwrap_err().to_string();
        assert!(fault.contains("found 192.0.2.7, expected addresses of this machine") && fault.contains("127.0.0.1"));
    }
}
